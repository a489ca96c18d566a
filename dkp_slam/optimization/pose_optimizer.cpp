#include "dkp_slam/optimization/pose_optimizer.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "dkp_slam/optimization/nearest_depth.h"

namespace dkp_slam {
namespace {

using Row6d = Eigen::Matrix<double, 1, 6>;

constexpr int rounds = 4;                // as ORB-SLAM
constexpr int iterations_per_round = 6;  // Gauss-Newton converges in two or three

/// Huber's weight of a squared, normalised residual.
double huber(double chi2, double bound) { return chi2 <= bound ? 1.0 : std::sqrt(bound / chi2); }

struct NormalEquations {
  Matrix6d h = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  void add(const Row6d& j, double residual, double weight) {
    h.noalias() += weight * j.transpose() * j;
    b.noalias() += weight * residual * j.transpose();
  }
};

class Problem {
 public:
  Problem(const Camera& camera, const MeasurementModel& model,
          const std::vector<PoseObservation>& observations)
      : camera_(camera), model_(model), observations_(observations) {}

  /// Squared pixel residual over its variance; infinite behind the camera.
  double pixel_chi2(const Se3& pose, const PoseObservation& o) const {
    const Eigen::Vector3d p = pose * o.landmark;
    if (p.z() < nearest_depth) return std::numeric_limits<double>::infinity();
    return (camera_.project(p) - o.seen.pixel).squaredNorm() /
           (o.seen.pixel_sigma * o.seen.pixel_sigma);
  }

  void accumulate(const Se3& pose, const PoseObservation& o, bool robust,
                  NormalEquations& sum) const {
    const Eigen::Vector3d p = pose * o.landmark;
    if (p.z() < nearest_depth) return;
    // Derivative of the camera point by a left perturbation of the pose: [I, -p x].
    const double iz = 1.0 / p.z(), fx = camera_.fx * iz, fy = camera_.fy * iz;
    const double x = p.x() * iz, y = p.y() * iz;
    Row6d ju, jv;
    ju << fx, 0.0, -fx * x, -camera_.fx * x * y, camera_.fx * (1.0 + x * x), -camera_.fx * y;
    jv << 0.0, fy, -fy * y, -camera_.fy * (1.0 + y * y), camera_.fy * x * y, camera_.fy * x;
    const Eigen::Vector2d r = camera_.project(p) - o.seen.pixel;
    const double information = 1.0 / (o.seen.pixel_sigma * o.seen.pixel_sigma);
    const double chi2 = r.squaredNorm() * information;
    const double weight = information * (robust ? huber(chi2, model_.pixel_chi2) : 1.0);
    sum.add(ju, r.x(), weight);
    sum.add(jv, r.y(), weight);
    if (o.seen.depth <= 0.0) return;
    Row6d jz;
    jz << 0.0, 0.0, 1.0, p.y(), -p.x(), 0.0;
    const double sigma = model_.depth_sigma(camera_, o.seen.depth);
    const double rz = p.z() - o.seen.depth;
    const double z2 = rz * rz / (sigma * sigma);
    // Depth stays robust in every round: a wrong reading at an edge leaves its pixel right.
    // Cauchy's weight, because such readings are wrong by any amount.
    sum.add(jz, rz, 1.0 / (sigma * sigma * (1.0 + z2 / model_.depth_chi2)));
  }

  int classify(const Se3& pose, std::vector<char>& inlier) const {
    int count = 0;
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      inlier[i] = pixel_chi2(pose, observations_[i]) <= model_.pixel_chi2;
      count += inlier[i];
    }
    return count;
  }

  Se3 iterate(Se3 pose, const std::vector<char>& use, bool robust) const {
    for (int i = 0; i < iterations_per_round; ++i) {
      NormalEquations sum;
      for (std::size_t k = 0; k < observations_.size(); ++k) {
        if (use[k]) accumulate(pose, observations_[k], robust, sum);
      }
      sum.h.diagonal().array() += 1e-6;  // keeps too few observations from dividing by zero
      const Vector6d step = sum.h.ldlt().solve(-sum.b);
      if (!step.allFinite()) break;
      pose = Se3::exp(step) * pose;
      if (step.norm() < 1e-7) break;
    }
    return pose;
  }

 private:
  const Camera& camera_;
  const MeasurementModel& model_;
  const std::vector<PoseObservation>& observations_;
};

}  // namespace

PoseEstimate optimize_pose(const Camera& camera, const MeasurementModel& model, const Se3& initial,
                           const std::vector<PoseObservation>& observations) {
  const Problem problem(camera, model, observations);
  PoseEstimate out{initial, std::vector<char>(observations.size(), 1),
                   static_cast<int>(observations.size())};
  if (observations.size() < 3) {
    out.inlier.assign(observations.size(), 0);
    out.inliers = 0;
    return out;
  }
  for (int round = 0; round < rounds; ++round) {
    // The kernel pulls in the first rounds; later the outliers are gone and it would only bias.
    out.camera_from_world = problem.iterate(out.camera_from_world, out.inlier, round < rounds - 1);
    out.inliers = problem.classify(out.camera_from_world, out.inlier);
    if (out.inliers < 3) break;
  }
  return out;
}

Matrix6d pose_information(const Camera& camera, const MeasurementModel& model,
                          const Se3& camera_from_world,
                          const std::vector<PoseObservation>& observations) {
  const Problem problem(camera, model, observations);
  constexpr bool robust = true;
  NormalEquations sum;
  for (const PoseObservation& o : observations) {
    problem.accumulate(camera_from_world, o, robust, sum);
  }
  return sum.h;
}

}  // namespace dkp_slam
