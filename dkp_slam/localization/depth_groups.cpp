#include "dkp_slam/localization/depth_groups.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>

#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/optimization/nearest_depth.h"

namespace dkp_slam {
namespace {

/// Landmarks whose own pose tells something, and as many as the pose may then rest on.
constexpr std::size_t least_group = 20;
constexpr std::size_t least_room = 40;
/// Median distance of landmarks from their middle, metres: of the jacket of somebody who hides half
/// of the view 0.07 to 0.21, of a desk 0.24 to 0.38, of what else is seen of a room 0.4 to 2.
constexpr double most_body = 0.22, least_room_extent = 0.3, larger = 3.0;
/// Own poses of near and far landmarks are so far apart, metres or radians, only where one of them
/// moves: in sequences that a hand turns (fr1_rpy and composites of it) they are in one frame of a
/// hundred at most, by rolling shutter and the depth camera's errors, and these show a desk.
constexpr double apart_way = 0.03, apart_angle = 0.03;
/// And so sure of it, of chi-square: neither covariance counts such errors.
constexpr double apart_chi2 = 100.0;
/// Share of a group that agrees on a pose: of a rigid one most; of somebody who turns as he goes
/// next to nothing.
constexpr double most = 0.5, few = 0.4;

/// Median distance from their middle, metres; at least one.
double extent_of(const std::vector<PoseObservation>& observations) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const PoseObservation& o : observations) middle += o.landmark;
  middle /= static_cast<double>(observations.size());
  std::vector<double> distances;
  distances.reserve(observations.size());
  for (const PoseObservation& o : observations) distances.push_back((o.landmark - middle).norm());
  const auto half = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), half, distances.end());
  return *half;
}

/// Where some of the landmarks take the camera to be.
struct OwnPose {
  Se3 camera_from_world;
  std::size_t members = 0;
  std::vector<std::size_t> agree;  ///< indices of those that do
  Matrix6d covariance;

  double share() const { return static_cast<double>(agree.size()) / static_cast<double>(members); }
};

OwnPose own_pose(const Camera& camera, const MeasurementModel& model, const Se3& initial,
                 const std::vector<PoseObservation>& all, const std::vector<std::size_t>& indices) {
  const PoseEstimate found = optimize_pose(camera, model, initial, some_of(all, indices));
  OwnPose own;
  own.camera_from_world = found.camera_from_world;
  own.members = indices.size();
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (found.inlier[i]) own.agree.push_back(indices[i]);
  }
  own.covariance = pose_information(camera, model, own.camera_from_world, some_of(all, own.agree))
                       .ldlt()
                       .solve(Matrix6d::Identity());
  return own;
}

/// Whether the other landmarks do not stand still where those of the room do.
bool are_apart(const OwnPose& room, const OwnPose& other) {
  if (other.agree.size() < least_group) {
    return other.members >= 2 * least_group && other.share() < few;
  }
  const Vector6d apart = (room.camera_from_world * other.camera_from_world.inverse()).log();
  if (apart.head<3>().norm() < apart_way && apart.tail<3>().norm() < apart_angle) return false;
  return apart.dot((room.covariance + other.covariance).ldlt().solve(apart)) > apart_chi2;
}

}  // namespace

std::vector<PoseObservation> some_of(const std::vector<PoseObservation>& all,
                                     const std::vector<std::size_t>& indices) {
  std::vector<PoseObservation> some;
  some.reserve(indices.size());
  for (const std::size_t i : indices) some.push_back(all[i]);
  return some;
}

DepthGroups split_by_depth(const Se3& camera_from_world,
                           const std::vector<PoseObservation>& observations, std::size_t least) {
  std::vector<double> nearness;
  nearness.reserve(observations.size());
  for (const PoseObservation& o : observations) {
    nearness.push_back(1.0 / std::max(nearest_depth, (camera_from_world * o.landmark).z()));
  }
  DepthGroups groups;
  std::vector<std::size_t>& order = groups.near;
  order.resize(observations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (order.size() < 2 * least) return groups;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return nearness[a] > nearness[b]; });
  double rest = std::accumulate(nearness.begin(), nearness.end(), 0.0), sum = 0.0, widest = -1.0;
  std::size_t split = least;
  for (std::size_t n = 1; n + least <= order.size(); ++n) {
    sum += nearness[order[n - 1]];
    rest -= nearness[order[n - 1]];
    const auto near = static_cast<double>(n), far = static_cast<double>(order.size() - n);
    const double between = near * far * std::pow(sum / near - rest / far, 2);
    if (n < least || between <= widest) continue;
    widest = between;
    split = n;
  }
  groups.far.assign(order.begin() + static_cast<std::ptrdiff_t>(split), order.end());
  order.resize(split);
  return groups;
}

std::vector<FrameMatch> matches_on_room(const Map& map, const MeasurementModel& model,
                                        const Frame& frame,
                                        const std::vector<FrameMatch>& matches) {
  const std::vector<PoseObservation> observations = observations_of(frame, matches, map, model);
  const DepthGroups groups = split_by_depth(frame.camera_from_world, observations, least_group);
  if (groups.far.empty()) return {};
  const double near = extent_of(some_of(observations, groups.near));
  const double far = extent_of(some_of(observations, groups.far));
  const double small = std::min(near, far), large = std::max(near, far);
  if (small > most_body || large < std::max(least_room_extent, larger * small)) return {};
  const auto own = [&](const std::vector<std::size_t>& indices) {
    return own_pose(map.camera(), model, frame.camera_from_world, observations, indices);
  };
  const OwnPose room = own(near > far ? groups.near : groups.far);
  if (room.agree.size() < least_room || room.share() < most) return {};
  if (!are_apart(room, own(near > far ? groups.far : groups.near))) return {};
  std::vector<FrameMatch> on_room;
  for (const std::size_t i : room.agree) on_room.push_back(matches[i]);
  return on_room;
}

}  // namespace dkp_slam
