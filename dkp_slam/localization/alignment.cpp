#include "dkp_slam/localization/alignment.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/ransac.h"
#include "dkp_slam/geometry/sensor_scale.h"

namespace dkp_slam {
namespace {

constexpr double behind = 0.05;  // metres; nearer points make no usable projection
constexpr int least_with_depth = 3;

class Aligner {
 public:
  Aligner(const Camera& camera, const MeasurementModel& model,
          std::span<const PoseObservation> observations, const AlignmentOptions& options,
          std::uint64_t seed)
      : camera_(camera), observations_(observations), options_(options), random_(seed) {
    for (const PoseObservation& o : observations) {
      seen_.push_back(camera.unproject(o.seen.pixel, o.seen.depth));
      sigma_.push_back(model.depth_sigma(camera, o.seen.depth));
      if (o.seen.depth > 0.0) with_depth_.push_back(seen_.size() - 1);
    }
  }

  std::optional<Alignment> run() {
    if (with_depth_.size() < least_with_depth) return std::nullopt;
    auto found = ransac<Alignment>(*this, options_.samples, 0);
    if (found.score < options_.least_inliers) return std::nullopt;
    return std::move(found.model);
  }

  /// For `ransac`: the pose of three observations with depth.
  std::optional<Alignment> sample() {
    std::array<std::size_t, 3> three;
    for (std::size_t& s : three) {
      s = with_depth_[static_cast<std::size_t>(
          random_.uniform(0, static_cast<int>(with_depth_.size())))];
    }
    if (!sides_fit(three)) return std::nullopt;
    return judge(fit(three));
  }

  int score(const Alignment& alignment, int /*best*/) const { return alignment.inliers; }

  /// Fitted anew to all inliers for as long as that brings more of them.
  void refine(Alignment& best, int& inliers) const {
    constexpr int rounds = 3;
    for (int i = 0; i < rounds; ++i) {
      std::vector<std::size_t> members;
      for (const std::size_t s : with_depth_) {
        if (best.inlier[s]) members.push_back(s);
      }
      if (members.size() < least_with_depth) break;
      Alignment next = judge(fit(members));
      if (next.inliers <= best.inliers) break;
      best = std::move(next);
    }
    inliers = best.inliers;
  }

  double samples_needed(const Alignment& best) const {
    double members = 0.0;
    for (const std::size_t s : with_depth_) members += best.inlier[s];
    const double good = std::pow(members / double(with_depth_.size()), 3.0);
    if (good >= 1.0) return 1.0;
    return std::log(1.0 - options_.confidence) / std::log(1.0 - good);
  }

 private:
  /// The triangle has the same sides in the world and before the camera, and no tiny one.
  bool sides_fit(const std::array<std::size_t, 3>& sample) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t a = sample[i], b = sample[(i + 1) % 3];
      const double before = (seen_[a] - seen_[b]).norm();
      const double world = (observations_[a].landmark - observations_[b].landmark).norm();
      if (std::min(before, world) < options_.least_side) return false;
      if (std::abs(before - world) > 0.02 + sigma_[a] + sigma_[b]) return false;
    }
    return true;
  }

  template <class Indices>
  Se3 fit(const Indices& indices) const {
    const auto n = static_cast<Eigen::Index>(indices.size());
    Eigen::Matrix3Xd from(3, n), to(3, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::size_t s = indices[static_cast<std::size_t>(i)];
      from.col(i) = observations_[s].landmark;
      to.col(i) = seen_[s];
    }
    const Eigen::Matrix4d m = Eigen::umeyama(from, to, false);
    return {Eigen::Quaterniond(m.topLeftCorner<3, 3>()).normalized(), m.topRightCorner<3, 1>()};
  }

  Alignment judge(const Se3& pose) const {
    Alignment out{pose, std::vector<char>(observations_.size(), 0), 0};
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    const double pixel_bound = SensorScale::of(camera_).pixels * options_.pixel_bound;
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      const Observation& seen = observations_[i].seen;
      const Eigen::Vector3d p = rotation * observations_[i].landmark + pose.translation;
      if (p.z() < behind) continue;
      const double bound = pixel_bound * seen.pixel_sigma;
      out.inlier[i] = (camera_.project(p) - seen.pixel).squaredNorm() <= bound * bound;
      out.inliers += out.inlier[i];
    }
    return out;
  }

  const Camera& camera_;
  const std::span<const PoseObservation> observations_;
  const AlignmentOptions& options_;
  std::vector<Eigen::Vector3d> seen_;  // camera frame; meaningless without depth
  std::vector<double> sigma_;          // of the depth, metres
  std::vector<std::size_t> with_depth_;
  cv::RNG random_;
};

}  // namespace

std::optional<Alignment> align_camera(const Camera& camera, const MeasurementModel& model,
                                      std::span<const PoseObservation> observations,
                                      const AlignmentOptions& options, std::uint64_t seed) {
  return Aligner(camera, model, observations, options, seed).run();
}

}  // namespace dkp_slam
