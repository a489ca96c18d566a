#include "dkp_slam/synth/figure/figure_skeleton.h"

#include <algorithm>
#include <cmath>

namespace dkp_slam {
namespace {

/// Close to `value` below `limit`, never above it, without a kink.
double soft_limit(double value, double limit) {
  constexpr double width = 0.006;
  const double below = 0.5 * (value + limit - std::hypot(value - limit, width));
  return std::max(below, 0.05);
}

/// Rotation whose third column is `up` and whose second is `hinge`, at right angles to it.
Eigen::Quaterniond orientation(const Eigen::Vector3d& up, const Eigen::Vector3d& hinge) {
  Eigen::Matrix3d axes;
  axes.col(2) = up;
  axes.col(1) = hinge;
  axes.col(0) = hinge.cross(up);
  return Eigen::Quaterniond(axes);
}

}  // namespace

Joint of_side(Joint left, int side) {
  if (side > 0) return left;
  const int hop = left >= Joint::left_thigh ? 4 : 3;
  return static_cast<Joint>(static_cast<int>(left) + hop);
}

PerJoint<Eigen::Vector3d> rest_joints(double scale, double shoulders) {
  PerJoint<Eigen::Vector3d> joints;
  joints[Joint::pelvis] = {0.0, 0.0, 0.93};
  joints[Joint::spine] = {-0.01, 0.0, 1.06};
  joints[Joint::chest] = {-0.015, 0.0, 1.22};
  joints[Joint::neck] = {-0.015, 0.0, 1.485};
  joints[Joint::head] = {0.005, 0.0, 1.565};
  for (const int side : {1, -1}) {
    const double arm = 0.185 * shoulders * side, leg = 0.09 * side;
    joints[of_side(Joint::left_upper_arm, side)] = {-0.01, arm, 1.425};
    joints[of_side(Joint::left_forearm, side)] = {-0.01, arm, 1.13};
    joints[of_side(Joint::left_hand, side)] = {-0.01, arm, 0.875};
    joints[of_side(Joint::left_thigh, side)] = {0.0, leg, 0.915};
    joints[of_side(Joint::left_shin, side)] = {0.0, leg, 0.485};
    joints[of_side(Joint::left_foot, side)] = {0.0, leg, 0.085};
    joints[of_side(Joint::left_toes, side)] = {0.125, leg, 0.02};
  }
  for (Eigen::Vector3d& joint : joints) joint *= scale;
  return joints;
}

LimbBend bend_limb(const Eigen::Vector3d& start, const Eigen::Vector3d& end,
                   const Eigen::Vector3d& pole, double upper, double lower, int fold) {
  const Eigen::Vector3d towards = end - start;
  const Eigen::Vector3d direction = towards.normalized();
  const double reach = soft_limit(towards.norm(), 0.999 * (upper + lower));
  const double shortest = std::max(reach, 1.02 * std::abs(upper - lower) + 0.02);
  const double cosine =
      (upper * upper + shortest * shortest - lower * lower) / (2.0 * upper * shortest);
  const double along = upper * std::clamp(cosine, -1.0, 1.0);
  const double aside = std::sqrt(std::max(upper * upper - along * along, 0.0));
  const Eigen::Vector3d outwards = (pole - pole.dot(direction) * direction).normalized();
  const Eigen::Vector3d middle = along * direction + aside * outwards;
  const Eigen::Vector3d hinge = fold * direction.cross(outwards);
  return {orientation(-middle.normalized(), hinge),
          orientation((middle - shortest * direction).normalized(), hinge)};
}

}  // namespace dkp_slam
