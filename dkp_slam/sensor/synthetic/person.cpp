#include "dkp_slam/sensor/synthetic/person.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dkp_slam/sensor/synthetic/patterns.h"

namespace dkp_slam {
namespace {

// Metres, of a figure 1.75 m tall.
constexpr double hip_height = 0.93;
constexpr double thigh = 0.43, shin = 0.43;
constexpr double upper_arm = 0.29, forearm = 0.25;
constexpr double stride = 1.4;  // two steps
// Radians.
constexpr double leg_swing = 0.42;
constexpr double arm_swing = 0.40;

}  // namespace

/// The walker's own axes at one moment.
struct Person::Frame {
  Eigen::Vector3d hip, forward, left, up;
  double scale;
  double phase;  ///< of the gait; 2 pi are two steps

  Eigen::Vector3d point(const Eigen::Vector3d& from, double f, double l, double u) const {
    return from + scale * (f * forward + l * left + u * up);
  }
  /// Down, turned forward by `angle`.
  Eigen::Vector3d swung(const Eigen::Vector3d& from, double length, double angle) const {
    return point(from, length * std::sin(angle), 0.0, -length * std::cos(angle));
  }
  Eigen::Matrix3d axes() const {
    Eigen::Matrix3d m;
    m << forward, left, up;
    return m;
  }
};

Person::Person(cv::RNG& rng, const WalkingLoop& loop)
    : loop_(loop), scale_(rng.uniform(0.95, 1.06)) {
  const auto colour = [&rng] {
    return cv::Scalar(rng.uniform(60.0, 190.0), rng.uniform(60.0, 190.0), rng.uniform(60.0, 190.0));
  };
  const auto cloth = [&rng](const cv::Scalar& base) {
    return std::make_shared<Texture>(cloth_pattern(rng, {512, 512}, base), true);
  };
  const cv::Scalar shirt = colour();
  shirt_ = cloth(shirt);
  sleeves_ = std::make_shared<Texture>(paint_pattern(rng, {256, 256}, shirt * 0.9, 14.0), true);
  trousers_ = std::make_shared<Texture>(
      paint_pattern(rng, {256, 256}, cv::Scalar(95, 70, 58) * rng.uniform(0.7, 1.3), 14.0), true);
  shoes_ =
      std::make_shared<Texture>(paint_pattern(rng, {128, 128}, cv::Scalar(45, 45, 50), 10.0), true);
  const cv::Scalar skin = cv::Scalar(140, 165, 215) * rng.uniform(0.65, 1.0);
  const cv::Scalar hair = cv::Scalar(40, 60, 85) * rng.uniform(0.5, 1.2);
  skin_ = std::make_shared<Texture>(paint_pattern(rng, {128, 128}, skin, 6.0), true);
  head_ = std::make_shared<Texture>(head_pattern(rng, {512, 256}, skin, hair), true);
}

std::vector<Solid> Person::at(double time) const {
  // Angle of the loop at constant speed of a circle of the mean radius: near enough to a walk.
  const double mean_radius = 0.5 * loop_.radii.sum();
  const double angle = loop_.start + loop_.speed * time / mean_radius;
  const Eigen::Vector2d spot =
      loop_.centre + loop_.radii.cwiseProduct(Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  const Eigen::Vector2d ahead =
      loop_.radii.cwiseProduct(Eigen::Vector2d(-std::sin(angle), std::cos(angle))).normalized();

  Frame frame;
  frame.scale = scale_;
  frame.phase = 2.0 * std::numbers::pi * loop_.speed * time / stride + loop_.start;
  frame.forward = {ahead.x(), ahead.y(), 0.0};
  frame.up = Eigen::Vector3d::UnitZ();
  frame.left = frame.up.cross(frame.forward);
  // The hip is highest when the legs pass each other.
  const double bob = 0.02 * std::cos(2.0 * frame.phase);
  frame.hip = {spot.x(), spot.y(), scale_ * (hip_height + bob)};

  std::vector<Solid> parts;
  add_trunk(frame, &parts);
  for (const double side : {-1.0, 1.0}) {
    const double phase = frame.phase + (side > 0.0 ? std::numbers::pi : 0.0);
    add_leg(frame, side, phase, &parts);
    add_arm(frame, side, phase + std::numbers::pi, &parts);
  }
  return parts;
}

void Person::add_trunk(const Frame& f, std::vector<Solid>* parts) const {
  const auto ellipsoid = [&](double height, const Eigen::Vector3d& radii, TexturePtr texture) {
    parts->push_back(Solid::ellipsoid(f.point(f.hip, 0.0, 0.0, height), f.axes(), f.scale * radii,
                                      std::move(texture)));
  };
  ellipsoid(0.00, {0.125, 0.170, 0.16}, trousers_);
  ellipsoid(0.25, {0.130, 0.185, 0.34}, shirt_);
  ellipsoid(0.70, {0.100, 0.080, 0.125}, head_);
  parts->push_back(Solid::capsule(f.point(f.hip, 0, 0.14, 0.46), f.point(f.hip, 0, -0.14, 0.46),
                                  0.085 * f.scale, f.forward, shirt_));
  parts->push_back(Solid::capsule(f.point(f.hip, 0, 0, 0.62), f.point(f.hip, 0, 0, 0.50),
                                  0.055 * f.scale, f.forward, skin_));
}

void Person::add_leg(const Frame& f, double side, double phase, std::vector<Solid>* parts) const {
  const double hip_angle = leg_swing * std::sin(phase);
  // The knee bends while the leg swings forward.
  const double knee_angle = 0.10 + 0.75 * std::max(0.0, std::cos(phase));
  const Eigen::Vector3d hip = f.point(f.hip, 0.0, 0.095 * side, -0.02);
  const Eigen::Vector3d knee = f.swung(hip, thigh, hip_angle);
  const Eigen::Vector3d ankle = f.swung(knee, shin, hip_angle - knee_angle);
  const Eigen::Vector3d toes = f.swung(ankle, 0.17, hip_angle - knee_angle + 1.35);
  parts->push_back(Solid::capsule(hip, knee, 0.085 * f.scale, f.forward, trousers_));
  parts->push_back(Solid::capsule(knee, ankle, 0.060 * f.scale, f.forward, trousers_));
  parts->push_back(Solid::capsule(ankle, toes, 0.045 * f.scale, f.up, shoes_));
}

void Person::add_arm(const Frame& f, double side, double phase, std::vector<Solid>* parts) const {
  const double shoulder_angle = arm_swing * std::sin(phase);
  const double elbow_angle = 0.30 + 0.20 * std::sin(phase);
  const Eigen::Vector3d shoulder = f.point(f.hip, 0.0, 0.215 * side, 0.45);
  const Eigen::Vector3d elbow = f.swung(shoulder, upper_arm, shoulder_angle);
  const Eigen::Vector3d wrist = f.swung(elbow, forearm, shoulder_angle + elbow_angle);
  const Eigen::Vector3d hand = f.swung(wrist, 0.07, shoulder_angle + elbow_angle);
  parts->push_back(Solid::capsule(shoulder, elbow, 0.052 * f.scale, f.forward, sleeves_));
  parts->push_back(Solid::capsule(elbow, wrist, 0.043 * f.scale, f.forward, sleeves_));
  parts->push_back(
      Solid::ellipsoid(hand, f.axes(), f.scale * Eigen::Vector3d(0.045, 0.030, 0.07), skin_));
}

}  // namespace dkp_slam
