#include "dkp_slam/sensor/synthetic/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace dkp_slam {
namespace {

/// Smaller positive root of a t^2 + 2 b t + c = 0.
std::optional<double> first_root(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0 || a <= 0.0) return std::nullopt;
  const double root = std::sqrt(discriminant);
  const double near = (-b - root) / a;
  if (near > 0.0) return near;
  const double far = (-b + root) / a;
  if (far > 0.0) return far;
  return std::nullopt;
}

std::optional<double> hit_ball(const Eigen::Vector3d& centre, double radius,
                               const Eigen::Vector3d& direction) {
  return first_root(direction.squaredNorm(), -direction.dot(centre),
                    centre.squaredNorm() - radius * radius);
}

std::optional<double> hit_capsule(const Solid& s, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d axis = s.axes.col(2);
  const double radius = s.radii[0];
  // The infinite cylinder first, in the plane across the axis.
  const double d_along = direction.dot(axis), c_along = s.centre.dot(axis);
  const Eigen::Vector3d d = direction - d_along * axis, c = s.centre - c_along * axis;
  const auto side = first_root(d.squaredNorm(), -d.dot(c), c.squaredNorm() - radius * radius);
  if (!side && d.squaredNorm() > 0.0) return std::nullopt;
  if (side && std::abs(*side * d_along - c_along) <= s.half_length) return side;
  std::optional<double> best;
  for (const double end : {-s.half_length, s.half_length}) {
    const auto cap = hit_ball(s.centre + end * axis, radius, direction);
    if (cap && (!best || *cap < *best)) best = cap;
  }
  return best;
}

}  // namespace

Solid Solid::ellipsoid(const Eigen::Vector3d& centre, const Eigen::Matrix3d& axes,
                       const Eigen::Vector3d& radii, TexturePtr texture) {
  return {centre, axes, radii, 0.0, std::move(texture)};
}

Solid Solid::capsule(const Eigen::Vector3d& top, const Eigen::Vector3d& bottom, double radius,
                     const Eigen::Vector3d& front, TexturePtr texture) {
  Eigen::Matrix3d axes;
  axes.col(2) = (top - bottom).normalized();
  axes.col(1) = axes.col(2).cross(front).normalized();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  return {0.5 * (top + bottom), axes, Eigen::Vector3d::Constant(radius),
          0.5 * (top - bottom).norm(), std::move(texture)};
}

double Solid::bound() const { return radii.maxCoeff() + half_length; }

Eigen::Vector3d Solid::normal_at(const Eigen::Vector3d& point) const {
  Eigen::Vector3d local = axes.transpose() * (point - centre);
  if (half_length > 0.0) {
    local.z() -= std::clamp(local.z(), -half_length, half_length);
  } else {
    local = local.cwiseQuotient(radii.cwiseAbs2());
  }
  return (axes * local).normalized();
}

Eigen::Vector2d Solid::uv_at(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = axes.transpose() * (point - centre);
  const double top = half_length > 0.0 ? half_length + radii[0] : radii[2];
  const double angle = std::atan2(local.y() / radii[1], local.x() / radii[0]);
  return {0.5 + angle / (2.0 * std::numbers::pi), 0.5 - 0.5 * local.z() / top};
}

Eigen::Vector2d Solid::texture_size() const {
  const double top = half_length > 0.0 ? half_length + radii[0] : radii[2];
  return {std::numbers::pi * (radii[0] + radii[1]), 2.0 * top};
}

Panel operator*(const Se3& pose, const Panel& panel) {
  return {pose * panel.origin, pose.rotation * panel.edge_u, pose.rotation * panel.edge_v,
          panel.texture};
}

Solid operator*(const Se3& pose, const Solid& solid) {
  Solid moved = solid;
  moved.centre = pose * solid.centre;
  moved.axes = pose.rotation.toRotationMatrix() * solid.axes;
  return moved;
}

std::optional<double> intersect(const Panel& panel, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d normal = panel.edge_u.cross(panel.edge_v);
  const double across = normal.dot(direction);
  if (across == 0.0) return std::nullopt;
  const double t = normal.dot(panel.origin) / across;
  if (!(t > 0.0)) return std::nullopt;
  const Eigen::Vector3d offset = t * direction - panel.origin;
  const double a = offset.dot(panel.edge_u), b = offset.dot(panel.edge_v);
  if (a < 0.0 || b < 0.0 || a > panel.edge_u.squaredNorm() || b > panel.edge_v.squaredNorm()) {
    return std::nullopt;
  }
  return t;
}

std::optional<double> intersect(const Solid& solid, const Eigen::Vector3d& direction) {
  if (solid.half_length > 0.0) return hit_capsule(solid, direction);
  const Eigen::Vector3d d = (solid.axes.transpose() * direction).cwiseQuotient(solid.radii);
  const Eigen::Vector3d c = (solid.axes.transpose() * solid.centre).cwiseQuotient(solid.radii);
  return first_root(d.squaredNorm(), -d.dot(c), c.squaredNorm() - 1.0);
}

}  // namespace dkp_slam
