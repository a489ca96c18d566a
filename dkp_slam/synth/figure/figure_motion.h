#pragma once

#include "dkp_slam/synth/figure/figure_gait.h"
#include "dkp_slam/synth/figure/figure_look.h"
#include "dkp_slam/synth/figure/figure_skeleton.h"

namespace dkp_slam {

/// A figure's joints at any time: feet from its gait, hips over the feet or on the seat, trunk over
/// the hips, hands where the gestures want them, legs and arms by inverse kinematics.
class FigureMotion {
 public:
  FigureMotion(const FigureOptions& options, const FigureLook& look);

  JointPoses joints(double time) const;
  Se3 root(double time) const;
  Se3 hands(double time) const;
  const PerJoint<Eigen::Vector3d>& rest() const { return rest_; }

  /// The seat's top above the floor, metres.
  static constexpr double seat_height = 0.45;

 private:
  struct Moment;
  struct HandPose;

  Moment moment(double time) const;
  Eigen::Vector3d ankle(const FootPose& foot) const;
  double hip_height(const Moment& now) const;
  void pose_trunk(const Moment& now, JointPoses& joints) const;
  void pose_leg(const Moment& now, int side, JointPoses& joints) const;
  void pose_arm(const Moment& now, int side, JointPoses& joints) const;
  HandPose hanging(const Moment& now, int side, const JointPoses& joints) const;
  HandPose gesturing(const Moment& now, Gesture gesture, int side) const;

  FigureLook look_;
  double scale_;
  FigureScript script_;
  PerJoint<Eigen::Vector3d> rest_;
  FigureGait gait_;
  std::array<double, 8> phases_;  ///< of the idle movements
};

}  // namespace dkp_slam
