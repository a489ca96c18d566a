#include "dkp_slam/tracking/path_smoother.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "dkp_slam/config/option_list.h"

namespace dkp_slam {
namespace {

/// Of a pose and the velocity there.
using Matrix12d = Eigen::Matrix<double, 12, 12>;
using Vector12d = Eigen::Matrix<double, 12, 1>;

constexpr std::size_t stretch = 256;       // poses that are solved at once
constexpr std::size_t chain_overlap = 64;  // beyond which poses have no influence
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

/// Weight after Cauchy of an error of so many squared sigmas: half at `doubtful` on each axis.
double trust(double squared_sigmas, double axes, double doubtful) {
  return 1.0 / (1.0 + squared_sigmas / (axes * doubtful * doubtful));
}

/// How much a pose is worth that rests on so many landmarks, of one that rests on enough. One that
/// was carried by its motion rests on none.
double support(int landmarks) {
  constexpr double enough = 200.0, least = 0.01;
  return std::clamp(landmarks / enough, least, 1.0);
}

/// Normal equations of a chain: each state is tied to the one before alone.
class Equations {
 public:
  explicit Equations(std::size_t states)
      : diagonal_(states, Matrix12d::Zero()),
        below_(states, Matrix12d::Zero()),
        right_(states, Vector12d::Zero()) {}

  /// An error of pose i, whose derivative by it is the identity.
  void add(std::size_t i, const Vector6d& weights, const Vector6d& error) {
    diagonal_[i].topLeftCorner<6, 6>() += weights.asDiagonal();
    right_[i].head<6>() -= weights.cwiseProduct(error);
  }
  /// An error of states i - 1 and i, with its derivatives by the two.
  template <int rows>
  void add(std::size_t i, const Eigen::Matrix<double, rows, rows>& weights,
           const Eigen::Matrix<double, rows, 1>& error,
           const Eigen::Matrix<double, rows, 12>& by_previous,
           const Eigen::Matrix<double, rows, 12>& by_this) {
    const Eigen::Matrix<double, 12, rows> this_weighted = by_this.transpose() * weights;
    const Eigen::Matrix<double, 12, rows> previous_weighted = by_previous.transpose() * weights;
    diagonal_[i].noalias() += this_weighted * by_this;
    right_[i].noalias() -= this_weighted * error;
    below_[i].noalias() += this_weighted * by_previous;
    diagonal_[i - 1].noalias() += previous_weighted * by_previous;
    right_[i - 1].noalias() -= previous_weighted * error;
  }
  /// The changes of all states; uses the equations up.
  std::vector<Vector12d> solve() {
    const std::size_t n = right_.size();
    for (std::size_t i = 1; i < n; ++i) {
      const Matrix12d up = diagonal_[i - 1].ldlt().solve(below_[i].transpose()).transpose();
      diagonal_[i].noalias() -= up * below_[i].transpose();
      right_[i].noalias() -= up * right_[i - 1];
    }
    for (std::size_t i = n; i-- > 0;) {
      if (i + 1 < n) right_[i].noalias() -= below_[i + 1].transpose() * right_[i + 1];
      right_[i] = diagonal_[i].ldlt().solve(right_[i]).eval();
    }
    return std::move(right_);
  }

 private:
  std::vector<Matrix12d> diagonal_, below_;  // below_[i]: row i, column i - 1
  std::vector<Vector12d> right_;
};

/// A chain of poses that are known, each by itself and from the one before.
class Chain {
 public:
  Chain(const std::vector<PathPose>& path, std::size_t begin, std::size_t end,
        const PathSmootherOptions& options)
      : tracked_(path.begin() + static_cast<std::ptrdiff_t>(begin),
                 path.begin() + static_cast<std::ptrdiff_t>(end)),
        of_pose_(inverse_variances(options.pose_translation, options.pose_rotation)),
        of_motion_(inverse_variances(options.motion_translation, options.motion_rotation)),
        of_velocity_(rate * inverse_variances(options.acceleration, options.angular_acceleration)),
        doubtful_(options.doubtful),
        velocities_(tracked_.size(), Vector6d::Zero()) {
    for (const PathPose& p : tracked_) poses_.push_back(p.camera_from_world);
    for (std::size_t i = poses_.size(); i-- > 1;) {
      if (tracked_[i].continues) velocities_[i - 1] = velocities_[i] = motion_into(i) / seconds(i);
    }
  }

  const std::vector<Se3>& solve() {
    for (int i = 0; i < iterations; ++i) {
      step(doubtful_ * std::exp2(static_cast<double>(std::max(0, narrowing - i))));
    }
    return poses_;
  }

 private:
  static constexpr double rate = 30.0;  // Hz, at which the options tell accelerations

  double seconds(std::size_t i) const { return tracked_[i].timestamp - tracked_[i - 1].timestamp; }
  Vector6d motion_into(std::size_t i) const { return (poses_[i] * poses_[i - 1].inverse()).log(); }

  /// One step of Gauss and Newton, poses moved on the camera's side: T <- exp(x) T.
  void step(double doubtful) {
    Equations equations(poses_.size());
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      hold_to_landmarks(i, doubtful, equations);
      if (i == 0) continue;
      hold_to_flow(i, doubtful, equations);
      hold_velocity(i, equations);
    }
    const std::vector<Vector12d> change = equations.solve();
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      poses_[i] = Se3::exp(change[i].head<6>()) * poses_[i];
      velocities_[i] += change[i].tail<6>();
    }
  }

  void hold_to_landmarks(std::size_t i, double doubtful, Equations& equations) const {
    const Vector6d off = (poses_[i] * tracked_[i].camera_from_world.inverse()).log();
    const Vector6d weights = support(tracked_[i].landmarks) * of_pose_;
    equations.add(i, trust(off.cwiseAbs2().dot(weights), 6.0, doubtful) * weights, off);
  }

  void hold_to_flow(std::size_t i, double doubtful, Equations& equations) const {
    if (!tracked_[i].from_previous) return;
    const Se3& motion = *tracked_[i].from_previous;
    const Vector6d strayed = (poses_[i] * poses_[i - 1].inverse() * motion.inverse()).log();
    const Matrix6d weights =
        (trust(strayed.cwiseAbs2().dot(of_motion_), 6.0, doubtful) * of_motion_).asDiagonal();
    Eigen::Matrix<double, 6, 12> by_previous = Eigen::Matrix<double, 6, 12>::Zero();
    Eigen::Matrix<double, 6, 12> by_this = by_previous;
    by_previous.leftCols<6>() = -adjoint(motion);
    by_this.leftCols<6>().setIdentity();
    equations.add<6>(i, weights, strayed, by_previous, by_this);
  }

  /// Position and velocity after this time without acceleration, and how far off an acceleration
  /// that is white noise may have brought both: over a time t by t^3 / 3, t^2 / 2 and t times its
  /// density (Anderson and Barfoot), whose inverse is 12 / t^3, -6 / t^2 and 4 / t.
  void hold_velocity(std::size_t i, Equations& equations) const {
    if (!tracked_[i].continues) return;
    const double t = seconds(i);
    const Vector6d motion = motion_into(i);
    const Matrix6d left = inverse_left_jacobian(motion), right = inverse_left_jacobian(-motion);
    Vector12d error;
    error << motion - t * velocities_[i - 1], left * velocities_[i] - velocities_[i - 1];
    Matrix12d by_previous, by_this = Matrix12d::Zero();
    const Matrix6d turned = 0.5 * lie_bracket(velocities_[i]);
    by_this.topLeftCorner<6, 6>() = left;
    by_this.bottomLeftCorner<6, 6>() = turned * left;
    by_this.bottomRightCorner<6, 6>() = left;
    by_previous << -right, -t * Matrix6d::Identity(), -turned * right, -Matrix6d::Identity();
    Matrix12d weights;
    weights << Matrix6d((12.0 / (t * t * t) * of_velocity_).asDiagonal()),
        Matrix6d((-6.0 / (t * t) * of_velocity_).asDiagonal()),
        Matrix6d((-6.0 / (t * t) * of_velocity_).asDiagonal()),
        Matrix6d((4.0 / t * of_velocity_).asDiagonal());
    // Never as good as least squares: where poses and motions leap the camera was knocked, or
    // images are missing, and they are right.
    const double steady = trust(error.dot(weights * error), 12.0, 0.5 * doubtful_);
    equations.add<12>(i, steady * weights, error, by_previous, by_this);
  }

  std::vector<PathPose> tracked_;
  Vector6d of_pose_, of_motion_, of_velocity_;
  double doubtful_;
  std::vector<Se3> poses_;
  std::vector<Vector6d> velocities_;  // of the camera in its own frame: T(t) = exp(t v) T
};

}  // namespace

void PathSmootherOptions::describe(OptionList& list) {
  list.add("smooth", smooth, "poses of the path by their neighbours and the motions between them");
  list.add("pose_translation", pose_translation, above(0), "metres", "a pose is off by itself");
  list.add("pose_rotation", pose_rotation, above(0), "radians", "a pose is off by itself");
  list.add("motion_translation", motion_translation, above(0), "metres", "a motion is off");
  list.add("motion_rotation", motion_rotation, above(0), "radians", "a motion is off");
  list.add("acceleration", acceleration, above(0), "m/s^2",
           "by which the camera's velocity varies");
  list.add("angular_acceleration", angular_acceleration, above(0), "rad/s^2",
           "by which its turning varies");
  list.add("doubtful", doubtful, above(0), "sigmas", "from which on each of these counts less");
}

void PathSmootherOptions::check() const { check_options(*this); }

void smooth_path(std::vector<PathPose>& path, const PathSmootherOptions& options) {
  if (!options.smooth) return;
  std::vector<Se3> smooth;
  smooth.reserve(path.size());
  while (smooth.size() < path.size()) {
    const std::size_t begin = smooth.size(), end = std::min(begin + stretch, path.size());
    const std::size_t from = begin - std::min(begin, chain_overlap);
    Chain chain(path, from, std::min(end + chain_overlap, path.size()), options);
    const std::vector<Se3>& poses = chain.solve();
    smooth.insert(smooth.end(), poses.begin() + static_cast<std::ptrdiff_t>(begin - from),
                  poses.begin() + static_cast<std::ptrdiff_t>(end - from));
  }
  for (std::size_t i = 0; i < path.size(); ++i) path[i].camera_from_world = smooth[i];
}

}  // namespace dkp_slam
