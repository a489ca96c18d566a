#include "dkp_slam/system/self_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "dkp_slam/localization/depth_groups.h"
#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/optimization/pose_optimizer.h"

namespace dkp_slam {
namespace {

/// Pixels that all landmarks of a view are off together: errors of the map itself, of the lens and
/// of the depth, which no number of landmarks averages out. With 0.5 one frame in 200 of seven
/// generated sequences lies over three sigma, with 0.3 one in 20 (docs/reliability.md).
constexpr double common_pixels = 0.6;
/// What stays however near and many they are, metres and radians: calibration and clocks of a real
/// camera. Chosen on fr1_xyz, whose true path has such errors of its own.
constexpr double least_way = 0.004, least_angle = 0.006;
/// What a motion measured from frame to frame is off, metres and radians a second, once nothing
/// else holds the pose.
constexpr double drift = 0.15;

/// Errors that the map, lens and depth make in all parts of a view average out less where people
/// hide a share of it; beyond this one what is left is known too little.
constexpr double most_hidden = 0.9;
/// Landmarks whose own pose tells something.
constexpr std::size_t least_group = 20;
/// A group's own pose is looked for this far from that of all, metres and radians: few landmarks in
/// a corner of the view would go anywhere.
constexpr double most_apart = 0.05;
/// A keyframe hands on no more, metres and radians: who sees only what it made is placed by that.
constexpr double most_doubt = 0.1;
/// 99 % of the chi-square distribution of six degrees of freedom.
constexpr double agreement_chi2 = 16.8;
/// Groups that disagreed have to agree for so long, seconds, before that is believed: a small group
/// agrees with anything.
constexpr double probation = 0.5;

/// A variance for the position, another for the orientation.
Matrix6d isotropic(double position, double orientation) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(position);
  covariance.diagonal().tail<3>().setConstant(orientation);
  return covariance;
}

/// What a motion measured for so long, seconds, is off.
Matrix6d drifted(double seconds) {
  const double off = drift * seconds;
  return isotropic(off * off, off * off);
}

/// What all landmarks of a view at this distance, metres, are off together.
Matrix6d common_error(const Camera& camera, double distance) {
  const double angle = common_pixels / camera.fx, way = angle * distance;
  return isotropic(way * way + least_way * least_way, angle * angle + least_angle * least_angle);
}

double depth_of(const Se3& camera_from_world, const PoseObservation& observation) {
  return (camera_from_world * observation.landmark).z();
}

/// Along the optical axis, metres; of no landmarks 0.
double mean_distance(const Se3& camera_from_world,
                     const std::vector<PoseObservation>& observations) {
  double sum = 0.0;
  for (const PoseObservation& o : observations) sum += depth_of(camera_from_world, o);
  return sum / std::max(1.0, static_cast<double>(observations.size()));
}

/// Standard deviation in the worst direction.
double worst_sigma(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(axes.eigenvalues().maxCoeff());
}

/// Where some of the landmarks take the camera to be: off the pose of all, and how sure.
struct OwnPose {
  Vector6d off;
  Matrix6d covariance;
};

OwnPose own_pose(const Camera& camera, const MeasurementModel& model, const Se3& of_all,
                 const std::vector<PoseObservation>& all, const std::vector<std::size_t>& group) {
  const std::vector<PoseObservation> observations = some_of(all, group);
  const Se3 own = optimize_pose(camera, model, of_all, observations).camera_from_world;
  const Matrix6d information = pose_information(camera, model, own, observations);
  const Eigen::LDLT<Matrix6d> held(information + Matrix6d::Identity() / (most_apart * most_apart));
  return {
      held.solve(information * (own * of_all.inverse()).log()),
      held.solve(Matrix6d::Identity()) + common_error(camera, mean_distance(own, observations))};
}

}  // namespace

Matrix6d PoseQuality::unknown() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return isotropic(infinity, infinity);
}

double PoseQuality::position_sigma() const { return worst_sigma(covariance.topLeftCorner<3, 3>()); }

PoseQuality SelfCheck::check(const Frame& frame, bool localised, int tracked,
                             const FrameDynamics& dynamics) {
  PoseQuality quality;
  if (!dynamics.mask.empty()) {
    quality.people_share =
        cv::countNonZero(dynamics.mask) / static_cast<double>(dynamics.mask.total());
  }
  if (localised && tracked > 0) {
    const auto [observations, of_others] = evidence(frame);
    compare_groups(frame, observations);
    const Doubt inherited = of_others ? inherited_doubt(frame) : carried_doubt(frame);
    const Doubt doubt{std::max(contest_.way, inherited.way),
                      std::max(contest_.angle, inherited.angle)};
    believed_ = measurement_covariance(frame.camera_from_world, observations) +
                isotropic(doubt.way * doubt.way, doubt.angle * doubt.angle);
    doubts_.resize(static_cast<std::size_t>(map_.keyframe_ids()), handed_on(believed_));
    map_seen_ = frame.timestamp;
    map_placed_in_ = map_.keyframe(frame.reference_keyframe).map;
    last_ = believed_ +
            common_error(map_.camera(), mean_distance(frame.camera_from_world, observations)) /
                (1.0 - std::min(quality.people_share, most_hidden));
  }
  quality.since_map_seen = frame.timestamp - map_seen_;
  if (!localised) return quality;
  quality.covariance = last_ + drifted(quality.since_map_seen);
  return quality;
}

/// What the frame saw of the map. Landmarks that it has just made itself agree with it anyhow.
SelfCheck::Evidence SelfCheck::evidence(const Frame& frame) const {
  std::vector<PoseObservation> seen, made;
  const int own = doubts_.size() < static_cast<std::size_t>(map_.keyframe_ids())
                      ? frame.reference_keyframe
                      : -1;  // the frame became no keyframe
  for (int i = 0; i < frame.features.size(); ++i) {
    const int l = frame.landmark[static_cast<std::size_t>(i)];
    if (l < 0 || !map_.has_landmark(l)) continue;
    const Landmark& landmark = map_.landmark(l);
    (landmark.first_keyframe == own ? made : seen)
        .push_back({landmark.position, observation_of(frame.features, i, map_, model_)});
  }
  const bool of_others = !seen.empty();  // the first of a map has none, nor one that was carried
  return {of_others ? std::move(seen) : std::move(made), of_others};
}

/// What the noise of pixels and depths leaves open.
Matrix6d SelfCheck::measurement_covariance(const Se3& camera_from_world,
                                           const std::vector<PoseObservation>& observations) const {
  if (observations.size() < 3) return PoseQuality::unknown();
  const Matrix6d covariance =
      pose_information(map_.camera(), model_, camera_from_world, observations)
          .ldlt()
          .solve(Matrix6d::Identity());
  // Of landmarks on a line without depth some motions cannot be told at all.
  return covariance.allFinite() ? covariance : PoseQuality::unknown();
}

/// Near and far landmarks, each by themselves, tell where the camera is. Where these poses differ
/// by more than both are wrong by, one of them lies on something that moves, and the pose is as far
/// off as it is from the one that lies on the room, which may be either, until they agree again.
void SelfCheck::compare_groups(const Frame& frame,
                               const std::vector<PoseObservation>& observations) {
  if (observations.size() < 2 * least_group) return;  // nothing new is known
  const Se3& camera_from_world = frame.camera_from_world;
  const DepthGroups groups = split_by_depth(camera_from_world, observations, least_group);
  const auto own = [&](const std::vector<std::size_t>& group) {
    return own_pose(map_.camera(), model_, camera_from_world, observations, group);
  };
  const OwnPose near = own(groups.near), far = own(groups.far);
  const Vector6d apart = near.off - far.off;
  const bool agree =
      apart.dot((near.covariance + far.covariance).ldlt().solve(apart)) <= agreement_chi2;
  if (agree) {
    if (frame.timestamp - contested_ > probation) contest_ = {};
    return;
  }
  contested_ = frame.timestamp;
  // Who is off by more than was looked for has lost his way altogether.
  const double way =
      std::min(std::max(near.off.head<3>().norm(), far.off.head<3>().norm()), most_apart);
  const double angle =
      std::min(std::max(near.off.tail<3>().norm(), far.off.tail<3>().norm()), most_apart);
  contest_ = {std::max(contest_.way, way), std::max(contest_.angle, angle)};
}

/// What a frame hands on to the landmarks that it makes: where it may be wrong relative to those it
/// saw, they are as well. Errors common to all landmarks are in both alike, and are no news.
SelfCheck::Doubt SelfCheck::handed_on(const Matrix6d& believed) {
  return {std::min(worst_sigma(believed.topLeftCorner<3, 3>()), most_doubt),
          std::min(worst_sigma(believed.bottomRightCorner<3, 3>()), most_doubt)};
}

/// Of a keyframe that sees nothing of the map: where it was carried to, if it goes on with that
/// map.
SelfCheck::Doubt SelfCheck::carried_doubt(const Frame& frame) const {
  if (map_.keyframe(frame.reference_keyframe).map != map_placed_in_) return {};
  return handed_on(believed_ + drifted(frame.timestamp - map_seen_));
}

/// A pose is known no better than the keyframes that made its landmarks. It weighs these alike,
/// and those of one keyframe are off together: the mean over landmarks is what it may be off.
SelfCheck::Doubt SelfCheck::inherited_doubt(const Frame& frame) const {
  Doubt mean;
  double landmarks = 0.0;
  for (const int l : frame.landmark) {
    if (l < 0 || !map_.has_landmark(l)) continue;
    const auto k = static_cast<std::size_t>(map_.landmark(l).first_keyframe);
    if (k >= doubts_.size()) continue;  // this frame has made it
    mean.way += doubts_[k].way;
    mean.angle += doubts_[k].angle;
    landmarks += 1.0;
  }
  if (landmarks == 0.0) return {};
  return {mean.way / landmarks, mean.angle / landmarks};
}

}  // namespace dkp_slam
