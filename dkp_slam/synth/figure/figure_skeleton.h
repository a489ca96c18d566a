#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// The joints of a figure; each turns what hangs on it. Parents come before their children.
enum class Joint : std::uint8_t {
  pelvis,
  spine,
  chest,
  neck,
  head,
  left_upper_arm,
  left_forearm,
  left_hand,
  right_upper_arm,
  right_forearm,
  right_hand,
  left_thigh,
  left_shin,
  left_foot,
  left_toes,
  right_thigh,
  right_shin,
  right_foot,
  right_toes,
};
constexpr std::size_t joint_count = 19;

/// `joint` of the left side, or its counterpart: side is 1 on the left, -1 on the right.
Joint of_side(Joint left, int side);

/// Something for each joint.
template <typename T>
struct PerJoint : std::array<T, joint_count> {
  T& operator[](Joint joint) { return this->at(static_cast<std::size_t>(joint)); }
  const T& operator[](Joint joint) const { return this->at(static_cast<std::size_t>(joint)); }
};

/// Stature for which the reference measures are given, metres.
constexpr double reference_height = 1.75;

/// Where the joints are in the figure that stands upright, arms down: x ahead, y left, z up from
/// the floor, metres. `scale` is the stature over `reference_height`; `shoulders` widens the chest.
PerJoint<Eigen::Vector3d> rest_joints(double scale, double shoulders);

/// World from joint; in the rest pose all rotations are the identity.
using JointPoses = PerJoint<Se3>;

/// Orientations of the two bones of a limb.
struct LimbBend {
  Eigen::Quaterniond upper, lower;
};

/// Two bones of lengths `upper` and `lower`, straight down in the rest pose, from `start` towards
/// `end`, the middle joint on the side of `pole` (a knee: ahead, an elbow: behind and below).
/// Where `end` is out of reach the limb stretches towards it, smoothly, and does not arrive.
/// `fold`: 1 if the lower bone folds towards +x of the limb (an arm), -1 towards -x (a leg).
LimbBend bend_limb(const Eigen::Vector3d& start, const Eigen::Vector3d& end,
                   const Eigen::Vector3d& pole, double upper, double lower, int fold);

}  // namespace dkp_slam
