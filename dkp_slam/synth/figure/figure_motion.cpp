#include "dkp_slam/synth/figure/figure_motion.h"

#include <algorithm>
#include <cmath>

#include "dkp_slam/synth/figure/figure_loft.h"

namespace dkp_slam {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double usual_speed = 1.1;  // metres per second

Quaterniond about_x(double angle) { return Quaterniond(AngleAxisd(angle, Vector3d::UnitX())); }
Quaterniond about_y(double angle) { return Quaterniond(AngleAxisd(angle, Vector3d::UnitY())); }
Quaterniond about_z(double angle) { return Quaterniond(AngleAxisd(angle, Vector3d::UnitZ())); }

/// The smaller one, without a kink where they are equal.
double soft_min(double a, double b, double width) {
  return 0.5 * (a + b - std::hypot(a - b, width));
}

/// 1 where a foot of this pitch rests on its ball, 0 where it rests on its heel.
double on_ball(double pitch) { return smooth_step(pitch, -0.15, 0.15); }

/// A slow movement without an audible period, -1 to 1.
double idle(double time, double period, double phase) {
  const double w = 2.0 * M_PI / period;
  return 0.6 * std::sin(w * time + phase) + 0.4 * std::sin(1.618 * w * time + 2.3 * phase);
}

/// Now and then to one side or the other, and back, -1 to 1.
double glances(double time, double period, double phase) {
  return std::tanh(2.5 * idle(time, period, phase));
}

}  // namespace

/// All that changes with time and that the limbs share.
struct FigureMotion::Moment {
  double time;
  Se3 root;
  double seated;
  double rising;  ///< 1 in the middle of sitting down or getting up
  std::array<double, gesture_count> gestures;
  std::array<FootPose, 2> feet;  ///< left, right
  double walking;                ///< 0 at rest, near 1 at a walker's speed
  double apart;                  ///< left foot ahead of the right one, metres, in the root's frame

  const FootPose& foot(int side) const { return feet[side > 0 ? 0 : 1]; }
  double of(Gesture gesture) const { return gestures[static_cast<std::size_t>(gesture)]; }
};

/// Where a wrist should be, relative to the middle of the shoulders, x ahead and z up, reference
/// metres; and how it is held.
struct FigureMotion::HandPose {
  Vector3d wrist;
  Vector3d elbow;     ///< direction in which the elbow points
  double palm = 0.0;  ///< turn of the hand about the forearm, 0: thumb towards the arm's inside
  double bend = 0.0;  ///< of the wrist, towards the palm
};

FigureMotion::FigureMotion(const FigureOptions& options, const FigureLook& look)
    : look_(look),
      scale_(look.height / reference_height),
      script_(options),
      rest_(rest_joints(scale_, look.shoulders)),
      gait_(script_, 0.63 * scale_ * look.stride * std::sqrt(options.walking_speed / usual_speed),
            options.walking_speed, (look.woman ? 0.15 : 0.19) * scale_, look.motion_seed % 2 == 0),
      phases_() {
  cv::RNG rng(look.motion_seed);
  for (double& phase : phases_) phase = rng.uniform(0.0, 6.28);
}

Se3 FigureMotion::root(double time) const {
  const Eigen::Vector2d place = script_.place(time);
  return {about_z(script_.heading(time)), {place.x(), place.y(), 0.0}};
}

FigureMotion::Moment FigureMotion::moment(double time) const {
  Moment now{};
  now.time = time;
  now.root = root(time);
  now.seated = script_.seated(time);
  now.rising = 4.0 * now.seated * (1.0 - now.seated);
  now.gestures = script_.gestures(time);
  now.feet = {gait_.foot(1, time), gait_.foot(-1, time)};
  const Eigen::Vector2d velocity = (script_.place(time + 0.05) - script_.place(time - 0.05)) / 0.1;
  now.walking = velocity.squaredNorm() / (velocity.squaredNorm() + 0.2);
  const Eigen::Vector2d between = now.feet[0].place - now.feet[1].place;
  const Vector3d ahead = now.root.rotation * Vector3d::UnitX();
  now.apart = between.dot(ahead.head<2>());
  return now;
}

/// Raised heels turn about the ball of the foot, raised toes about the heel.
Vector3d FigureMotion::ankle(const FootPose& foot) const {
  const Vector3d flat = rest_[Joint::left_foot];
  const Vector3d ball = rest_[Joint::left_toes] - flat, heel(-0.07 * scale_, 0.0, -flat.z());
  const Vector3d pivot = heel + on_ball(foot.pitch) * (ball - heel);
  const Quaterniond heading = about_z(foot.heading);
  const Vector3d under(foot.place.x(), foot.place.y(), flat.z() + foot.lift);
  return under + heading * (pivot - about_y(foot.pitch) * pivot);
}

double FigureMotion::hip_height(const Moment& now) const {
  const double leg = rest_[Joint::left_thigh].z() - rest_[Joint::left_foot].z();
  // Nobody walks or stands on legs stretched to the last.
  double height = rest_[Joint::left_foot].z() + 0.993 * leg;
  for (const int side : {1, -1}) {
    const Vector3d foot = now.root.inverse() * ankle(now.foot(side));
    const double stretch = 0.996 * leg, ahead = std::min(std::abs(foot.x()), 0.9 * leg);
    // A foot in the air holds nobody down.
    const double free = 6.0 * now.foot(side).lift;
    height = soft_min(height, foot.z() + free + std::sqrt(stretch * stretch - ahead * ahead),
                      0.015 * scale_);
  }
  return height;
}

void FigureMotion::pose_trunk(const Moment& now, JointPoses& joints) const {
  const double t = now.time, sit = now.seated, stand = 1.0 - sit;
  const double walking = now.walking;
  const double shift = (now.foot(-1).lift - now.foot(1).lift) * 0.45;
  const double weight = stand * 0.012 * idle(t, 9.0, phases_[0]) * (1.0 - walking);
  // On the seat the hips lie a hand's breadth behind its middle.
  const double hips_back = -(FigureScript::seat_behind + 0.06);
  const double seated_height = seat_height + 0.085 * look_.build * scale_;
  const double above_hips = rest_[Joint::pelvis].z() - rest_[Joint::left_thigh].z();
  const Vector3d hips(sit * hips_back - 0.02 * now.rising, shift + weight,
                      stand * hip_height(now) + sit * seated_height);
  const double lean = 0.55 * now.rising - 0.10 * sit + 0.04 * stand * walking +
                      0.16 * sit * now.of(Gesture::type) - 0.05 * now.of(Gesture::carry);
  const double sway = 0.22 * now.apart / scale_;  // the hip of the leading leg goes ahead
  joints[Joint::pelvis] = now.root * Se3(about_z(-sway * stand) * about_x(0.9 * shift) *
                                             about_y(0.6 * lean - 0.12 * sit),
                                         hips + Vector3d(0.0, 0.0, above_hips));
  const auto attach = [&](Joint joint, Joint parent, const Quaterniond& turn) {
    joints[joint] = joints[parent] * Se3(turn, rest_[joint] - rest_[parent]);
  };
  const double breath = 0.012 * std::sin(2.0 * M_PI * t / 3.7 + phases_[1]);
  attach(Joint::spine, Joint::pelvis,
         about_z(0.8 * sway * stand) * about_x(-0.9 * shift) * about_y(0.25 * lean + 0.10 * sit));
  const double look_down = now.of(Gesture::type) * 0.10;
  attach(Joint::chest, Joint::spine,
         about_z(0.9 * sway * stand + 0.06 * sit * idle(t, 14.0, phases_[2])) *
             about_x(0.03 * sit * idle(t, 17.0, phases_[3])) * about_y(0.15 * lean + breath));
  attach(Joint::neck, Joint::chest,
         about_z(-0.4 * sway * stand) * about_y(0.10 - 0.4 * lean + look_down));
  const double still = 1.0 - 0.7 * walking - 0.5 * now.of(Gesture::type);
  const double talking = now.of(Gesture::talk) * 0.06 * std::sin(4.1 * t + phases_[4]);
  attach(Joint::head, Joint::neck,
         about_z(still * 0.42 * glances(t, 11.0, phases_[5]) - 0.4 * sway * stand) *
             about_x(0.06 * idle(t, 8.0, phases_[6])) *
             about_y(-0.10 - 0.3 * lean + look_down + talking + 0.06 * idle(t, 7.0, phases_[7])));
}

void FigureMotion::pose_leg(const Moment& now, int side, JointPoses& joints) const {
  const Joint thigh = of_side(Joint::left_thigh, side), shin = of_side(Joint::left_shin, side);
  const Joint foot = of_side(Joint::left_foot, side), toes = of_side(Joint::left_toes, side);
  const FootPose& pose = now.foot(side);
  const Quaterniond heading = about_z(pose.heading);
  const Quaterniond turn = heading * about_y(pose.pitch);
  const Vector3d target = ankle(pose);
  const Vector3d hip = joints[Joint::pelvis] * (rest_[thigh] - rest_[Joint::pelvis]);
  const Vector3d knee = heading * Vector3d(1.0, 0.10 * side, 0.25);
  const double upper = (rest_[thigh] - rest_[shin]).norm();
  const double lower = (rest_[shin] - rest_[foot]).norm();
  const LimbBend bend = bend_limb(hip, target, knee, upper, lower, -1);
  joints[thigh] = {bend.upper, hip};
  joints[shin] = {bend.lower, joints[thigh] * (rest_[shin] - rest_[thigh])};
  joints[foot] = {turn, joints[shin] * (rest_[foot] - rest_[shin])};
  // The toes stay on the floor while the heel is up.
  const double up = pose.pitch * on_ball(pose.pitch);
  joints[toes] = joints[foot] * Se3(about_y(-up), rest_[toes] - rest_[foot]);
}

FigureMotion::HandPose FigureMotion::hanging(const Moment& now, int side,
                                             const JointPoses& joints) const {
  // Arms swing against the legs.
  const double ahead = -side * now.apart / scale_ * (1.0 - now.seated);
  const double swing = 0.62 * look_.swing * ahead;
  const double bend = 0.22 + 0.35 * look_.swing * (ahead + std::hypot(ahead, 0.2)) * 0.5;
  const double away = 0.09 + 0.25 * std::max(look_.build - 1.0, 0.0);
  const Quaterniond upper = about_x(side * away) * about_y(-swing);
  const Quaterniond lower = upper * about_y(-bend);
  const double upper_arm = 0.295, forearm = 0.255;
  const Vector3d down = -Vector3d::UnitZ();
  HandPose pose;
  pose.wrist = Vector3d(0.0, 0.185 * look_.shoulders * side, 0.0) + upper_arm * (upper * down) +
               forearm * (lower * down);
  pose.elbow = {-1.0, 0.35 * side, 0.0};
  pose.palm = 0.35;
  pose.bend = 0.12;
  // On the thighs when seated.
  const Vector3d middle = 0.5 * (joints[Joint::left_upper_arm].translation +
                                 joints[Joint::right_upper_arm].translation);
  const Vector3d on_thigh =
      now.root.inverse() * joints[Joint::pelvis].translation +
      scale_ * Vector3d(0.20 + 0.02 * idle(now.time, 12.0, phases_[4] + side),
                        side * (0.11 + 0.02 * idle(now.time, 15.0, phases_[6] + side)), 0.125);
  const Vector3d lap = (on_thigh - now.root.inverse() * middle) / scale_;
  pose.wrist += now.seated * (lap - pose.wrist);
  pose.palm += now.seated * (1.2 - pose.palm);
  pose.elbow += now.seated * Vector3d(0.2, 0.4 * side, -0.4);
  return pose;
}

FigureMotion::HandPose FigureMotion::gesturing(const Moment& now, Gesture gesture, int side) const {
  const double t = now.time, s = side;
  HandPose pose;
  pose.elbow = {-0.5, 0.6 * s, -0.8};
  switch (gesture) {
    case Gesture::carry:
      pose.wrist = {0.32, 0.17 * s, -0.33};
      break;
    case Gesture::type:
      pose.wrist = {0.34 + 0.008 * std::sin(9.0 * t + s),
                    0.10 * s + 0.02 * idle(t, 3.0, phases_[2] + s),
                    -0.28 + 0.006 * std::sin(17.0 * t + 2.0 * s)};
      pose.elbow = {-0.4, 0.7 * s, -0.8};
      pose.palm = 1.5;
      break;
    case Gesture::talk: {
      const double beat = t + (side > 0 ? 0.0 : 0.9);
      pose.wrist = {0.26 + 0.07 * idle(beat, 1.7, phases_[3]),
                    (0.17 + 0.05 * idle(beat, 2.3, phases_[5])) * s,
                    -0.22 + 0.09 * idle(beat, 2.0, phases_[7])};
      pose.palm = -0.5 + 0.4 * idle(beat, 2.6, phases_[1]);
      break;
    }
    case Gesture::phone:
      pose.wrist = {0.115, 0.135 * s, 0.03};
      pose.elbow = {0.0, 0.45 * s, -1.0};
      pose.bend = 0.25;
      break;
    case Gesture::wave: {
      const double beat = std::sin(2.0 * M_PI * 1.3 * t + phases_[4]);
      pose.wrist = {0.20, (0.40 + 0.07 * beat) * s, 0.19};
      pose.elbow = {-0.1, 0.7 * s, -1.0};
      pose.palm = 1.2;
      break;
    }
    case Gesture::point:
      pose.wrist = {0.50, 0.10 * s + 0.02 * idle(t, 2.5, phases_[3]),
                    0.00 + 0.02 * idle(t, 3.0, phases_[6])};
      pose.elbow = {-0.2, 0.5 * s, -1.0};
      pose.palm = 0.8;
      break;
    case Gesture::none:
      break;
  }
  return pose;
}

void FigureMotion::pose_arm(const Moment& now, int side, JointPoses& joints) const {
  const Joint upper = of_side(Joint::left_upper_arm, side);
  const Joint lower = of_side(Joint::left_forearm, side);
  const Joint hand = of_side(Joint::left_hand, side);
  HandPose pose = hanging(now, side, joints);
  // Phone, wave and point are for the right hand alone.
  const auto both = [](Gesture g) {
    return g == Gesture::carry || g == Gesture::type || g == Gesture::talk;
  };
  HandPose sum{Vector3d::Zero(), Vector3d::Zero(), 0.0, 0.0};
  double rest = 1.0;
  for (std::size_t i = 1; i < gesture_count; ++i) {
    const auto gesture = static_cast<Gesture>(i);
    const double share = now.gestures[i];
    if (share <= 0.0 || (side > 0 && !both(gesture))) continue;
    const HandPose goal = gesturing(now, gesture, side);
    sum.wrist += share * goal.wrist;
    sum.elbow += share * goal.elbow;
    sum.palm += share * goal.palm;
    sum.bend += share * goal.bend;
    rest -= share;
  }
  sum.wrist += rest * pose.wrist;
  sum.elbow += rest * pose.elbow;
  sum.palm += rest * pose.palm;
  sum.bend += rest * pose.bend;

  // The shoulders' middle, turned as the chest is about the vertical.
  const Vector3d middle = 0.5 * (joints[Joint::left_upper_arm].translation +
                                 joints[Joint::right_upper_arm].translation);
  const Vector3d across =
      joints[Joint::left_upper_arm].translation - joints[Joint::right_upper_arm].translation;
  const Quaterniond turn = about_z(std::atan2(-across.x(), across.y()));
  const Vector3d shoulder = joints[upper].translation;
  const Vector3d wrist = middle + turn * (scale_ * sum.wrist);
  const LimbBend bend =
      bend_limb(shoulder, wrist, turn * sum.elbow, (rest_[upper] - rest_[lower]).norm(),
                (rest_[lower] - rest_[hand]).norm(), 1);
  joints[upper].rotation = bend.upper;
  joints[lower] = {bend.lower, joints[upper] * (rest_[lower] - rest_[upper])};
  joints[hand] = joints[lower] * Se3(about_z(-side * sum.palm) * about_x(-side * sum.bend),
                                     rest_[hand] - rest_[lower]);
}

JointPoses FigureMotion::joints(double time) const {
  const Moment now = moment(time);
  JointPoses joints;
  pose_trunk(now, joints);
  for (const int side : {1, -1}) {
    const Joint upper = of_side(Joint::left_upper_arm, side);
    joints[upper] =
        joints[Joint::chest] * Se3(Quaterniond::Identity(), rest_[upper] - rest_[Joint::chest]);
  }
  for (const int side : {1, -1}) {
    pose_leg(now, side, joints);
    pose_arm(now, side, joints);
  }
  return joints;
}

Se3 FigureMotion::hands(double time) const {
  const JointPoses now = joints(time);
  const Vector3d palm(0.0, 0.0, -0.075 * scale_);
  const Vector3d middle = 0.5 * (now[Joint::left_hand] * palm + now[Joint::right_hand] * palm);
  return {about_z(script_.heading(time)), middle};
}

}  // namespace dkp_slam
