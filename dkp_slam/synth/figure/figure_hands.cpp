#include <array>
#include <cmath>

#include "dkp_slam/synth/figure/figure_body.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

/// A finger of some length from its knuckle down, curled by moving its end towards `curl`.
SkinnedMesh finger(const Vector3d& knuckle, const Vector3d& direction, const Vector3d& curl,
                   double length, double radius, Joint hand) {
  LoftShape shape;
  shape.sections = {{0.012, .6 * radius, .6 * radius, .6 * radius, 2.0},
                    {0.000, radius, radius, radius, 2.0},
                    {-0.6 * length, .92 * radius, .92 * radius, .92 * radius, 2.0},
                    {-0.92 * length, .70 * radius, .70 * radius, .70 * radius, 2.0},
                    {-length, .15 * radius, .15 * radius, .15 * radius, 2.0}};
  shape.rows = 6;
  shape.sides = 6;
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(-Vector3d::UnitZ(), direction.normalized());
  const Vector3d local_curl = turn.conjugate() * curl;
  return loft(
      shape, {turn, knuckle}, [&](const Vector3d&) { return Influence::of(hand); },
      [&](double, const Vector3d& p) -> Vector3d {
        const double t = std::max(-p.z() / length, 0.0);
        return p + t * t * local_curl;
      });
}

SkinnedMesh hand(const FigureLook& look, int side) {
  const Joint joint = of_side(Joint::left_hand, side);
  const double y = 0.185 * look.shoulders * side, x = -0.01;
  const double girth = look.woman ? 0.88 : 1.0;
  LoftShape palm;
  palm.sections = {{0.895, .012, .014, .014, 2.0}, {0.885, .020, .027, .026, 2.0},
                   {0.865, .018, .028, .027, 2.2}, {0.840, .016, .034, .032, 2.4},
                   {0.805, .015, .042, .040, 2.6}, {0.778, .013, .041, .039, 2.6},
                   {0.768, .008, .034, .033, 2.4}, {0.766, .002, .010, .010, 2.0}};
  for (Section& s : palm.sections) {
    s.side *= girth;
    s.front *= girth;
    s.back *= girth;
  }
  palm.rows = 10;
  palm.sides = 12;
  SkinnedMesh skin = loft(palm, {Eigen::Quaterniond::Identity(), Vector3d(x, y, 0.0)},
                          [&](const Vector3d&) { return Influence::of(joint); });
  const Vector3d inwards(0.0, -side, 0.0);
  const std::array<double, 4> across = {0.030, 0.010, -0.010, -0.029};
  const std::array<double, 4> length = {0.074, 0.083, 0.077, 0.060};
  for (std::size_t i = 0; i < 4; ++i) {
    append(finger({x + girth * across[i], y, 0.778}, {0.15 * across[i] / 0.03, 0.0, -1.0},
                  0.025 * inwards, length[i], 0.0100 * girth, joint),
           skin);
  }
  append(finger({x + 0.026 * girth, y - 0.004 * side, 0.845}, Vector3d(0.62, -0.35 * side, -0.72),
                Vector3d(-0.012, 0.0, -0.006), 0.072, 0.0125 * girth, joint),
         skin);
  return skin;
}

}  // namespace

SkinnedMesh figure_hands(const FigureLook& look) {
  SkinnedMesh both = hand(look, 1);
  append(hand(look, -1), both);
  return both;
}

}  // namespace dkp_slam
