#include "dkp_slam/optimization/dense_bundle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "dkp_slam/optimization/nearest_depth.h"

namespace dkp_slam {
namespace {

using Matrix63d = Eigen::Matrix<double, 6, 3>;

/// The steps' size, as Ceres keeps it (Madsen, Nielsen and Tingleff 2004, §3.2).
class TrustRegion {
 public:
  double damping() const { return 1.0 / radius_; }
  void accepted(double gain) {
    constexpr double largest = 1e16;
    radius_ = std::min(largest, radius_ / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3)));
    shrink_ = 2.0;
  }
  void refused() {
    radius_ /= shrink_;
    shrink_ *= 2.0;
  }

 private:
  double radius_ = 1e4, shrink_ = 2.0;
};

class DenseBundle {
 public:
  DenseBundle(const Camera& camera, const MeasurementModel& model, const BundleProblem& problem,
              BundleSolution& state)
      : camera_(camera),
        pixel_chi2_(model.pixel_chi2),
        depth_chi2_(model.depth_chi2),
        state_(state) {
    for (const BundleProblem::Pose& p : state.poses) {
      free_index_.push_back(p.fixed ? -1 : free_poses_++);
    }
    sort_by_point(model, problem);
    pose_hessian_.resize(static_cast<std::size_t>(free_poses_));
    pose_gradient_.resize(static_cast<std::size_t>(free_poses_));
    point_hessian_.resize(state.points.size());
    point_gradient_.resize(state.points.size());
    mixed_.resize(sightings_.size());
  }

  bool solve(int iterations, const std::atomic<bool>* stop) {
    constexpr double enough = 1e-5;      // relative change of the cost
    constexpr double least_gain = 1e-3;  // of what the linear model promises
    TrustRegion region;
    double cost = linearise();
    for (int i = 0; i < iterations; ++i) {
      if (stop && *stop) return false;
      const double promised = find_step(region.damping());
      const std::vector<BundleProblem::Pose> poses = state_.poses;
      const std::vector<BundleProblem::Point> points = state_.points;
      double moved = std::numeric_limits<double>::infinity();
      if (promised > 0.0) {
        take_step();
        moved = cost_now();
      }
      const double gain = (cost - moved) / promised;
      if (!(promised > 0.0 && gain > least_gain)) {
        state_.poses = poses;
        state_.points = points;
        region.refused();
        continue;
      }
      region.accepted(gain);
      const bool done = cost - moved <= enough * cost;
      cost = moved;
      if (done || i + 1 == iterations) break;
      linearise();
    }
    return std::isfinite(cost);
  }

 private:
  struct Sighting {
    int pose = -1;
    int free = -1;  // of the pose among those that move; -1 for one that does not
    int point = -1;
    Eigen::Vector2d pixel;
    double pixel_scale = 1.0;  // one over sigma
    double depth = 0.0;
    double depth_scale = 0.0;  // 0 where the depth is unknown
  };
  struct Rigid {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
  };
  /// Residuals of a sighting, over their sigmas, and what they cost.
  struct Residual {
    Eigen::Vector3d p;      // camera frame
    double z = 0.0;         // of the projection: never behind the camera
    Eigen::Vector3d value;  // u, v, depth
    double pixel_weight = 1.0, depth_weight = 0.0;
    double cost = 0.0;
  };

  void sort_by_point(const MeasurementModel& model, const BundleProblem& problem) {
    first_.assign(problem.points.size() + 1, 0);
    for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
      if (!state_.outlier[i]) ++first_[static_cast<std::size_t>(problem.sightings[i].point) + 1];
    }
    for (std::size_t j = 1; j < first_.size(); ++j) first_[j] += first_[j - 1];
    sightings_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
      if (state_.outlier[i]) continue;
      const BundleProblem::Sighting& s = problem.sightings[i];
      const bool deep = s.seen.depth > 0.0;
      sightings_[next[static_cast<std::size_t>(s.point)]++] = {
          s.pose,
          free_index_[static_cast<std::size_t>(s.pose)],
          s.point,
          s.seen.pixel,
          1.0 / s.seen.pixel_sigma,
          s.seen.depth,
          deep ? 1.0 / model.depth_sigma(camera_, s.seen.depth) : 0.0};
    }
  }

  std::vector<Rigid> rigid_poses() const {
    std::vector<Rigid> out;
    out.reserve(state_.poses.size());
    for (const BundleProblem::Pose& p : state_.poses) {
      out.push_back(
          {p.camera_from_world.rotation.toRotationMatrix(), p.camera_from_world.translation});
    }
    return out;
  }

  Residual residual(const Sighting& s, const Rigid& pose, const Eigen::Vector3d& point) const {
    Residual r;
    r.p = pose.rotation * point + pose.translation;
    r.z = std::max(r.p.z(), nearest_depth);
    r.value[0] = s.pixel_scale * (camera_.fx * r.p.x() / r.z + camera_.cx - s.pixel.x());
    r.value[1] = s.pixel_scale * (camera_.fy * r.p.y() / r.z + camera_.cy - s.pixel.y());
    r.value[2] = s.depth_scale * (r.p.z() - s.depth);
    const double pixel2 = r.value.head<2>().squaredNorm();
    if (pixel2 <= pixel_chi2_) {
      r.cost = 0.5 * pixel2;
    } else {
      const double a = std::sqrt(pixel_chi2_), length = std::sqrt(pixel2);
      r.cost = a * length - 0.5 * pixel_chi2_;
      r.pixel_weight = a / length;
    }
    if (s.depth_scale > 0.0) {
      // A wrong depth at an edge is wrong by any amount: Cauchy's loss forgets it.
      const double share = r.value[2] * r.value[2] / depth_chi2_;
      r.cost += 0.5 * depth_chi2_ * std::log1p(share);
      r.depth_weight = 1.0 / (1.0 + share);
    }
    return r;
  }

  double cost_now() const {
    const std::vector<Rigid> poses = rigid_poses();
    double cost = 0.0;
    for (const Sighting& s : sightings_) {
      cost += residual(s, poses[static_cast<std::size_t>(s.pose)],
                       state_.points[static_cast<std::size_t>(s.point)].position)
                  .cost;
    }
    return cost;
  }

  /// Hessians and gradients where the state is; returns the cost.
  double linearise() {
    std::fill(pose_hessian_.begin(), pose_hessian_.end(), Matrix6d::Zero());
    std::fill(pose_gradient_.begin(), pose_gradient_.end(), Vector6d::Zero());
    std::fill(point_hessian_.begin(), point_hessian_.end(), Eigen::Matrix3d::Zero());
    std::fill(point_gradient_.begin(), point_gradient_.end(), Eigen::Vector3d::Zero());
    const std::vector<Rigid> poses = rigid_poses();
    double cost = 0.0;
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      const Sighting& s = sightings_[i];
      const auto point = static_cast<std::size_t>(s.point);
      const Rigid& pose = poses[static_cast<std::size_t>(s.pose)];
      const Residual r = residual(s, pose, state_.points[point].position);
      cost += r.cost;
      // Derivative of (u, v, depth) by the point in the camera frame, and its products.
      Eigen::Matrix3d by_point = Eigen::Matrix3d::Zero();
      by_point(0, 0) = s.pixel_scale * camera_.fx / r.z;
      by_point(0, 2) = -by_point(0, 0) * r.p.x() / r.z;
      by_point(1, 1) = s.pixel_scale * camera_.fy / r.z;
      by_point(1, 2) = -by_point(1, 1) * r.p.y() / r.z;
      by_point(2, 2) = s.depth_scale;
      const Eigen::Vector3d weight(r.pixel_weight, r.pixel_weight, r.depth_weight);
      const Eigen::Matrix3d weighted = by_point.transpose() * weight.asDiagonal();
      const Eigen::Matrix3d hessian = weighted * by_point;
      const Eigen::Vector3d gradient = weighted * r.value;
      const Eigen::Matrix3d by_landmark = hessian * pose.rotation;
      point_hessian_[point].noalias() += pose.rotation.transpose() * by_landmark;
      point_gradient_[point].noalias() += pose.rotation.transpose() * gradient;
      if (s.free < 0) continue;
      // By a left perturbation (translation, rotation) of the pose: [I, -skew(p)].
      const Eigen::Matrix3d turn = skew(r.p);
      const auto f = static_cast<std::size_t>(s.free);
      const Eigen::Matrix3d turned = turn * hessian;  // (-skew(p))^T = skew(p)
      pose_hessian_[f].topLeftCorner<3, 3>() += hessian;
      pose_hessian_[f].bottomLeftCorner<3, 3>() += turned;
      pose_hessian_[f].bottomRightCorner<3, 3>().noalias() -= turned * turn;
      pose_gradient_[f].head<3>() += gradient;
      pose_gradient_[f].tail<3>().noalias() += turn * gradient;
      mixed_[i].topRows<3>() = by_landmark;
      mixed_[i].bottomRows<3>().noalias() = turn * by_landmark;
    }
    for (Matrix6d& h : pose_hessian_)
      h.topRightCorner<3, 3>() = h.bottomLeftCorner<3, 3>().transpose();
    return cost;
  }

  /// Solves for the step, damped by this share of the Hessians' diagonals. Returns by how much the
  /// linear model says that the cost falls; not positive where there is no such step.
  double find_step(double damping) {
    const Eigen::Index size = 6 * static_cast<Eigen::Index>(free_poses_);
    reduced_.setZero(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    for (int f = 0; f < free_poses_; ++f) {
      const auto k = static_cast<std::size_t>(f);
      reduced_.block<6, 6>(6 * f, 6 * f) = damped(pose_hessian_[k], damping);
      right.segment<6>(6 * f) = -pose_gradient_[k];
    }
    inverses_.resize(point_hessian_.size());
    for (std::size_t j = 0; j + 1 < first_.size(); ++j) eliminate(j, damping, right);
    const Eigen::LLT<Eigen::MatrixXd, Eigen::Lower> factor(reduced_);
    if (size > 0 && factor.info() != Eigen::Success) return -1.0;
    pose_step_ = size > 0 ? Eigen::VectorXd(factor.solve(right)) : right;
    return substitute_back(damping);
  }

  /// What damping adds to a Hessian's diagonal.
  template <int N>
  static Eigen::Matrix<double, N, 1> added(const Eigen::Matrix<double, N, N>& hessian,
                                           double damping) {
    constexpr double least = 1e-6;
    return damping * hessian.diagonal().cwiseMax(least);
  }

  template <int N>
  static Eigen::Matrix<double, N, N> damped(const Eigen::Matrix<double, N, N>& hessian,
                                            double damping) {
    Eigen::Matrix<double, N, N> out = hessian;
    out.diagonal() += added(hessian, damping);
    return out;
  }

  /// Takes a point out of the poses' system (its lower half).
  void eliminate(std::size_t point, double damping, Eigen::VectorXd& right) {
    const std::size_t begin = first_[point], end = first_[point + 1];
    inverses_[point].setZero();
    if (begin == end) return;
    bool usable = false;
    damped(point_hessian_[point], damping).computeInverseWithCheck(inverses_[point], usable, 0.0);
    if (!usable) inverses_[point].setZero();
    for (std::size_t a = begin; a < end; ++a) {
      const int row = sightings_[a].free;
      if (row < 0) continue;
      const Matrix63d carried = mixed_[a] * inverses_[point];
      right.segment<6>(6 * row).noalias() += carried * point_gradient_[point];
      for (std::size_t b = begin; b < end; ++b) {
        const int column = sightings_[b].free;
        if (column < 0 || column > row) continue;
        reduced_.block<6, 6>(6 * row, 6 * column).noalias() -= carried * mixed_[b].transpose();
      }
    }
  }

  /// The points' steps, and what the whole step promises: half of step * (D step - gradient).
  double substitute_back(double damping) {
    double twice = 0.0;
    for (int f = 0; f < free_poses_; ++f) {
      const auto k = static_cast<std::size_t>(f);
      const Vector6d step = pose_step_.segment<6>(6 * f);
      twice += step.dot(added(pose_hessian_[k], damping).cwiseProduct(step) - pose_gradient_[k]);
    }
    point_step_.assign(point_hessian_.size(), Eigen::Vector3d::Zero());
    for (std::size_t j = 0; j < point_step_.size(); ++j) {
      Eigen::Vector3d right = -point_gradient_[j];
      for (std::size_t a = first_[j]; a < first_[j + 1]; ++a) {
        const int free = sightings_[a].free;
        if (free < 0) continue;
        right.noalias() -= mixed_[a].transpose() * pose_step_.segment<6>(6 * free);
      }
      point_step_[j] = inverses_[j] * right;
      const Eigen::Vector3d diagonal = added(point_hessian_[j], damping);
      twice += point_step_[j].dot(diagonal.cwiseProduct(point_step_[j]) - point_gradient_[j]);
    }
    return 0.5 * twice;
  }

  void take_step() {
    for (std::size_t i = 0; i < state_.poses.size(); ++i) {
      if (free_index_[i] < 0) continue;
      const Vector6d step = pose_step_.segment<6>(6 * free_index_[i]);
      Se3& pose = state_.poses[i].camera_from_world;
      pose = Se3::exp(step) * pose;
    }
    for (std::size_t j = 0; j < point_step_.size(); ++j)
      state_.points[j].position += point_step_[j];
  }

  const Camera& camera_;
  const double pixel_chi2_, depth_chi2_;
  BundleSolution& state_;
  std::vector<int> free_index_;  // of each pose among those that move; -1 for the others
  int free_poses_ = 0;
  std::vector<Sighting> sightings_;  // by point
  std::vector<std::size_t> first_;   // of each point's sightings, and the end
  std::vector<Matrix6d> pose_hessian_;
  std::vector<Vector6d> pose_gradient_;
  std::vector<Eigen::Matrix3d> point_hessian_, inverses_;
  std::vector<Eigen::Vector3d> point_gradient_, point_step_;
  std::vector<Matrix63d> mixed_;  // Hessian's block of pose and point, per sighting of a free pose
  Eigen::MatrixXd reduced_;
  Eigen::VectorXd pose_step_;
};

}  // namespace

bool solve_dense_bundle(const Camera& camera, const MeasurementModel& model,
                        const BundleProblem& problem, int iterations, const std::atomic<bool>* stop,
                        BundleSolution& state) {
  return DenseBundle(camera, model, problem, state).solve(iterations, stop) && !(stop && *stop);
}

}  // namespace dkp_slam
