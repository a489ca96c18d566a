#include "dkp_slam/calibration/readout_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "dkp_slam/geometry/rolling_shutter.h"
#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/optimization/nearest_depth.h"

namespace dkp_slam {
namespace {

constexpr std::size_t group_size = 6;
constexpr std::size_t most_groups = 40;
constexpr int least_points = 50;         // of a group
constexpr std::size_t least_groups = 4;  // whose scatter says anything

/// What a group says of the readout alone: second and first derivative of its cost.
struct Reduced {
  double h = 0.0, g = 0.0;
  double step() const { return -g / h; }
};

struct GroupKeyframe {
  int id = -1;
  Vector6d velocity = Vector6d::Zero();  // as of at_middle_row
};

/// Motion per second about a moment of the path, camera to later camera; nothing at its gaps.
std::optional<Vector6d> velocity_at(const Trajectory& path, double time) {
  constexpr double most_apart = 0.15;  // seconds
  const auto at =
      std::lower_bound(path.begin(), path.end(), time,
                       [](const StampedPose& pose, double t) { return pose.timestamp < t - 1e-6; });
  if (at == path.end() || std::abs(at->timestamp - time) > 1e-6) return std::nullopt;
  const auto before = at == path.begin() ? at : at - 1;
  const auto after = at + 1 == path.end() ? at : at + 1;
  const double passed = after->timestamp - before->timestamp;
  if (!(passed > 0.0 && passed < most_apart)) return std::nullopt;
  return (after->world_from_camera.inverse() * before->world_from_camera).log() / passed;
}

std::vector<std::vector<GroupKeyframe>> groups_of(const Map& map, const Trajectory& path) {
  std::vector<std::vector<GroupKeyframe>> groups;
  for (int which = 0; which < map.maps(); ++which) {
    std::vector<GroupKeyframe> group;
    for (const int id : map.keyframes_in(which)) {
      const auto velocity = velocity_at(path, map.keyframe(id).timestamp);
      if (map.keyframe(id).removed || !velocity) continue;
      group.push_back({id, *velocity});
      if (group.size() < group_size) continue;
      groups.push_back(std::move(group));
      group.clear();
    }
  }
  if (groups.size() <= most_groups) return groups;
  std::vector<std::vector<GroupKeyframe>> some;
  for (std::size_t i = 0; i < most_groups; ++i) {
    some.push_back(std::move(groups[i * groups.size() / most_groups]));
  }
  return some;
}

class Group {
 public:
  Group(const Map& map, const MeasurementModel& model, const std::vector<GroupKeyframe>& keyframes)
      : map_(map), model_(model), camera_(map.camera()), keyframes_(keyframes) {
    // The first pose stays: a group's place in the world is nothing that it measures.
    const auto size = static_cast<Eigen::Index>(6 * (keyframes.size() - 1) + 1);
    h_ = Eigen::MatrixXd::Zero(size, size);
    g_ = Eigen::VectorXd::Zero(size);
  }

  /// Nothing where too few landmarks connect the keyframes.
  std::optional<Reduced> reduce() {
    int points = 0;
    for (const auto& [landmark, seen] : sightings()) {
      if (seen.size() < 2) continue;
      eliminate(map_.landmark(landmark).position, seen);
      ++points;
    }
    if (points < least_points) return std::nullopt;
    const Eigen::Index poses = h_.rows() - 1;
    Eigen::MatrixXd of_poses = h_.topLeftCorner(poses, poses);
    constexpr double held = 1e-9;  // relative: a pose that nothing holds stays
    of_poses.diagonal() *= 1.0 + held;
    of_poses.diagonal().array() += held;
    const Eigen::LDLT<Eigen::MatrixXd> factors(of_poses);
    const Eigen::VectorXd mixed = h_.col(poses).head(poses);
    Reduced reduced;
    reduced.h = h_(poses, poses) - mixed.dot(factors.solve(mixed));
    reduced.g = g_[poses] - mixed.dot(factors.solve(g_.head(poses)));
    if (!(reduced.h > 0.0) || !std::isfinite(reduced.g)) return std::nullopt;
    return reduced;
  }

 private:
  struct Seen {
    std::size_t keyframe = 0;  // of the group
    int feature = -1;
  };

  std::map<int, std::vector<Seen>> sightings() const {
    std::map<int, std::vector<Seen>> out;
    for (std::size_t k = 0; k < keyframes_.size(); ++k) {
      const std::vector<int>& landmarks = map_.keyframe(keyframes_[k].id).landmarks;
      for (std::size_t f = 0; f < landmarks.size(); ++f) {
        if (landmarks[f] >= 0) out[landmarks[f]].push_back({k, static_cast<int>(f)});
      }
    }
    return out;
  }

  /// Of the undistorted pixel that a feature has at the middle row's moment, by the readout.
  Eigen::Vector2d by_readout(const FrameFeatures& features, std::size_t f,
                             const Vector6d& velocity) const {
    constexpr double step = 1e-3;  // seconds
    Camera later = camera_;
    later.readout += step;
    const ImagePoint point{features.seen_pixel[f], features.seen_depth[f]};
    const float row = features.raw_pixel[f].y;
    const cv::Point2f moved = at_middle_row(later, point, row, velocity).pixel -
                              at_middle_row(camera_, point, row, velocity).pixel;
    return Eigen::Vector2d(moved.x, moved.y) / step;
  }

  /// Adds what a landmark's sightings say, the landmark itself eliminated.
  void eliminate(const Eigen::Vector3d& point, const std::vector<Seen>& seen) {
    const auto rows = static_cast<Eigen::Index>(3 * seen.size());
    const auto columns = static_cast<Eigen::Index>(6 * seen.size() + 1);
    Eigen::MatrixXd by_rest = Eigen::MatrixXd::Zero(rows, columns);
    Eigen::MatrixXd by_point(rows, 3);
    Eigen::VectorXd error(rows);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(3 * i), column = static_cast<Eigen::Index>(6 * i);
      linearise(point, seen[i], row, column, error, by_rest, by_point);
    }
    const Eigen::Matrix3d of_point =
        by_point.transpose() * by_point + 1e-9 * Eigen::Matrix3d::Identity();
    const Eigen::MatrixXd mixed = by_point.transpose() * by_rest;
    const Eigen::Matrix3d inverse = of_point.inverse();
    const Eigen::MatrixXd h = by_rest.transpose() * by_rest - mixed.transpose() * (inverse * mixed);
    const Eigen::VectorXd g = by_rest.transpose() * error -
                              mixed.transpose() * (inverse * (by_point.transpose() * error));
    scatter(seen, h, g);
  }

  /// Residuals of a sighting, over their sigmas and by their robust weights, and derivatives.
  void linearise(const Eigen::Vector3d& point, const Seen& seen, Eigen::Index row,
                 Eigen::Index column, Eigen::VectorXd& error, Eigen::MatrixXd& by_rest,
                 Eigen::MatrixXd& by_point) const {
    const GroupKeyframe& k = keyframes_[seen.keyframe];
    const Keyframe& keyframe = map_.keyframe(k.id);
    const Observation o = observation_of(keyframe.features, seen.feature, map_, model_);
    const Eigen::Vector3d p = keyframe.camera_from_world * point;
    const double z = std::max(p.z(), nearest_depth);  // never behind the camera
    const Eigen::Vector2d pixels = (camera_.project({p.x(), p.y(), z}) - o.pixel) / o.pixel_sigma;
    const double depth_scale = o.depth > 0.0 ? 1.0 / model_.depth_sigma(camera_, o.depth) : 0.0;
    const double depth = depth_scale * (p.z() - o.depth);
    const double pixel_weight =
        std::min(1.0, std::sqrt(std::sqrt(model_.pixel_chi2 / (pixels.squaredNorm() + 1e-12))));
    const double depth_weight = 1.0 / std::sqrt(1.0 + depth * depth / model_.depth_chi2);
    Eigen::Matrix3d by_camera_point = Eigen::Matrix3d::Zero();
    by_camera_point.row(0) << camera_.fx / z, 0.0, -camera_.fx * p.x() / (z * z);
    by_camera_point.row(1) << 0.0, camera_.fy / z, -camera_.fy * p.y() / (z * z);
    by_camera_point.topRows<2>() *= pixel_weight / o.pixel_sigma;
    by_camera_point(2, 2) = depth_weight * depth_scale;
    Eigen::Matrix<double, 3, 6> by_pose;  // of the left perturbation: translation, rotation
    by_pose.leftCols<3>() = by_camera_point;
    by_pose.rightCols<3>() = -by_camera_point * skew(p);
    error.segment<3>(row) << pixel_weight * pixels, depth_weight * depth;
    by_rest.block<3, 6>(row, column) = by_pose;
    const auto f = static_cast<std::size_t>(seen.feature);
    by_rest.block<2, 1>(row, by_rest.cols() - 1) =
        -pixel_weight / o.pixel_sigma * by_readout(keyframe.features, f, k.velocity);
    by_point.middleRows<3>(row) =
        by_camera_point * keyframe.camera_from_world.rotation.toRotationMatrix();
  }

  /// Adds a landmark's equations to where its keyframes and the readout have their places.
  void scatter(const std::vector<Seen>& seen, const Eigen::MatrixXd& h, const Eigen::VectorXd& g) {
    const auto place = [&](std::size_t i) {  // of a block in h_, -1 for the pose that stays
      if (i == seen.size()) return h_.rows() - 1;
      return 6 * (static_cast<Eigen::Index>(seen[i].keyframe) - 1);
    };
    const auto width = [&](std::size_t i) { return Eigen::Index{i == seen.size() ? 1 : 6}; };
    for (std::size_t i = 0; i <= seen.size(); ++i) {
      const auto from_i = static_cast<Eigen::Index>(6 * i);
      if (place(i) < 0) continue;
      g_.segment(place(i), width(i)) += g.segment(from_i, width(i));
      for (std::size_t j = 0; j <= seen.size(); ++j) {
        if (place(j) < 0) continue;
        h_.block(place(i), place(j), width(i), width(j)) +=
            h.block(from_i, static_cast<Eigen::Index>(6 * j), width(i), width(j));
      }
    }
  }

  const Map& map_;
  const MeasurementModel& model_;
  const Camera& camera_;
  const std::vector<GroupKeyframe>& keyframes_;
  Eigen::MatrixXd h_;  // of poses but the first, then the readout
  Eigen::VectorXd g_;
};

}  // namespace

ReadoutCheck check_readout(const Map& map, const MeasurementModel& model, const Trajectory& path) {
  std::vector<Reduced> all;
  Reduced sum;
  for (const std::vector<GroupKeyframe>& keyframes : groups_of(map, path)) {
    const std::optional<Reduced> reduced = Group(map, model, keyframes).reduce();
    if (!reduced) continue;
    all.push_back(*reduced);
    sum.h += reduced->h;
    sum.g += reduced->g;
  }
  if (all.size() < least_groups) return {};
  double scatter = 0.0;
  for (const Reduced& r : all) {
    const double change = Reduced{sum.h - r.h, sum.g - r.g}.step() - sum.step();
    scatter += change * change;
  }
  const auto n = static_cast<double>(all.size());
  return {sum.step(), std::sqrt(scatter * (n - 1.0) / n), static_cast<int>(n)};
}

std::string readout_warning(const ReadoutCheck& check, const Camera& camera) {
  constexpr double least = 0.008;  // seconds: what is found is a little less than what is wrong
  constexpr double sure = 5.0;     // standard deviations
  if (check.groups == 0) return {};
  if (!(std::abs(check.change) > std::max(least, sure * check.sigma))) return {};
  constexpr double ms = 1000.0;
  return fmt::format(
      "by the images the camera's readout is about {:.0f} ms, not {:.0f}: find it by `dkp-slam "
      "calibrate SEQUENCE --out camera.yaml` and run with --camera camera.yaml",
      ms * std::max(0.0, camera.readout + check.change), ms * camera.readout);
}

}  // namespace dkp_slam
