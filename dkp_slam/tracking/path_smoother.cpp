#include "dkp_slam/tracking/path_smoother.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "dkp_slam/config/option_list.h"

namespace dkp_slam {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t stretch = 256;  // poses that are solved at once
constexpr std::size_t overlap = 32;   // beyond which poses have no influence
/// The first as good as plain least squares, then each with half the kernel's width until it is the
/// one asked for: a pose that is far off would else vouch for itself.
constexpr int iterations = 8, narrowing = 5;

/// Of translation and rotation, both per axis.
Vector6d inverse_variances(double translation, double rotation) {
  Vector6d w;
  w.head<3>().setConstant(1.0 / (translation * translation));
  w.tail<3>().setConstant(1.0 / (rotation * rotation));
  return w;
}

/// Of tangents: exp(adjoint(T) * x) = T exp(x) T^-1.
Matrix6d adjoint(const Se3& t) {
  const Eigen::Matrix3d r = t.rotation.toRotationMatrix();
  Matrix6d a = Matrix6d::Zero();
  a.topLeftCorner<3, 3>() = r;
  a.bottomRightCorner<3, 3>() = r;
  a.topRightCorner<3, 3>() = skew(t.translation) * r;
  return a;
}

/// Weight of an error after Cauchy: half at `doubtful` sigmas.
double trust(const Vector6d& error, const Vector6d& weights, double doubtful) {
  return 1.0 / (1.0 + error.cwiseAbs2().dot(weights) / (6.0 * doubtful * doubtful));
}

/// How much a pose is worth that rests on so many landmarks, of one that rests on enough. One that
/// was carried by its motion rests on none.
double support(int landmarks) {
  constexpr double enough = 200.0, least = 0.01;
  return std::clamp(landmarks / enough, least, 1.0);
}

/// A chain of poses that are known, each by itself and from the one before.
class Chain {
 public:
  Chain(const std::vector<PathPose>& path, std::size_t begin, std::size_t end,
        const PathSmootherOptions& options)
      : tracked_(path.begin() + static_cast<std::ptrdiff_t>(begin),
                 path.begin() + static_cast<std::ptrdiff_t>(end)),
        of_pose_(inverse_variances(options.pose_translation, options.pose_rotation)),
        of_motion_(inverse_variances(options.motion_translation, options.motion_rotation)),
        doubtful_(options.doubtful) {
    for (const PathPose& p : tracked_) poses_.push_back(p.camera_from_world);
  }

  const std::vector<Se3>& solve() {
    for (int i = 0; i < iterations; ++i) {
      step(doubtful_ * std::exp2(static_cast<double>(std::max(0, narrowing - i))));
    }
    return poses_;
  }

 private:
  /// One step of Gauss and Newton, poses moved on the camera's side: T <- exp(x) T.
  void step(double doubtful) {
    const std::size_t n = poses_.size();
    std::vector<Matrix6d> diagonal(n), below(n);  // below[i]: row i, column i - 1
    std::vector<Vector6d> right(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vector6d off = (poses_[i] * tracked_[i].camera_from_world.inverse()).log();
      const Vector6d weights = support(tracked_[i].landmarks) * of_pose_;
      const Vector6d w = trust(off, weights, doubtful) * weights;
      diagonal[i] = w.asDiagonal();
      right[i] = -w.cwiseProduct(off);
      below[i].setZero();
      if (i == 0 || !tracked_[i].from_previous) continue;
      const Se3& motion = *tracked_[i].from_previous;
      const Vector6d strayed = (poses_[i] * poses_[i - 1].inverse() * motion.inverse()).log();
      const Vector6d v = trust(strayed, of_motion_, doubtful) * of_motion_;
      const Matrix6d to_previous = adjoint(motion);
      diagonal[i] += v.asDiagonal();
      right[i] -= v.cwiseProduct(strayed);
      below[i].noalias() = -(v.asDiagonal() * to_previous);
      diagonal[i - 1] -= to_previous.transpose() * below[i];
      right[i - 1] += to_previous.transpose() * v.cwiseProduct(strayed);
    }
    for (std::size_t i = 1; i < n; ++i) {
      const Matrix6d up = diagonal[i - 1].ldlt().solve(below[i].transpose()).transpose();
      diagonal[i] -= up * below[i].transpose();
      right[i] -= up * right[i - 1];
    }
    Vector6d x = Vector6d::Zero();
    for (std::size_t i = n; i-- > 0;) {
      if (i + 1 < n) right[i] -= below[i + 1].transpose() * x;
      x = diagonal[i].ldlt().solve(right[i]);
      poses_[i] = Se3::exp(x) * poses_[i];
    }
  }

  std::vector<PathPose> tracked_;
  Vector6d of_pose_, of_motion_;
  double doubtful_;
  std::vector<Se3> poses_;
};

}  // namespace

void PathSmootherOptions::describe(OptionList& list) {
  list.add("smooth", smooth, "poses of the path by the motions between them");
  list.add("pose_translation", pose_translation, above(0), "metres", "a pose is off by itself");
  list.add("pose_rotation", pose_rotation, above(0), "radians", "a pose is off by itself");
  list.add("motion_translation", motion_translation, above(0), "metres", "a motion is off");
  list.add("motion_rotation", motion_rotation, above(0), "radians", "a motion is off");
  list.add("doubtful", doubtful, above(0), "sigmas", "from which on poses and motions count less");
}

void PathSmootherOptions::check() const { check_options(*this); }

void smooth_path(std::vector<PathPose>& path, const PathSmootherOptions& options) {
  if (!options.smooth) return;
  std::vector<Se3> smooth;
  smooth.reserve(path.size());
  while (smooth.size() < path.size()) {
    const std::size_t begin = smooth.size(), end = std::min(begin + stretch, path.size());
    const std::size_t from = begin - std::min(begin, overlap);
    Chain chain(path, from, std::min(end + overlap, path.size()), options);
    const std::vector<Se3>& poses = chain.solve();
    smooth.insert(smooth.end(), poses.begin() + static_cast<std::ptrdiff_t>(begin - from),
                  poses.begin() + static_cast<std::ptrdiff_t>(end - from));
  }
  for (std::size_t i = 0; i < path.size(); ++i) path[i].camera_from_world = smooth[i];
}

}  // namespace dkp_slam
