#pragma once

#include <memory>
#include <optional>

#include <Eigen/Core>

#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/sensor/synthetic/mesh.h"

namespace dkp_slam {

/// A textured rectangle: origin + a edge_u + b edge_v, a and b in 0..1, edges at right angles,
/// metres. Seen from both sides.
struct Panel {
  Eigen::Vector3d origin, edge_u, edge_v;
  TexturePtr texture;

  Eigen::Vector3d normal() const { return edge_u.cross(edge_v).normalized(); }
};

/// An ellipsoid, or a capsule: the hull of two balls. Metres.
struct Solid {
  Eigen::Vector3d centre;
  /// Columns: the solid's own axes. The texture runs around the third one, its middle column at the
  /// first one, its top row at the third one's tip.
  Eigen::Matrix3d axes;
  Eigen::Vector3d radii;     ///< of the ellipsoid along its axes; of the capsule: the first one
  double half_length = 0.0;  ///< along the third axis, of a capsule; 0: an ellipsoid
  TexturePtr texture;

  static Solid ellipsoid(const Eigen::Vector3d& centre, const Eigen::Matrix3d& axes,
                         const Eigen::Vector3d& radii, TexturePtr texture);
  /// From `top` to `bottom` (the centres of the balls); `front` is where the texture's middle is.
  static Solid capsule(const Eigen::Vector3d& top, const Eigen::Vector3d& bottom, double radius,
                       const Eigen::Vector3d& front, TexturePtr texture);

  /// Radius of a ball around the centre that holds the solid.
  double bound() const;
  /// Outward unit normal and texture coordinates at a point of the surface.
  Eigen::Vector3d normal_at(const Eigen::Vector3d& point) const;
  Eigen::Vector2d uv_at(const Eigen::Vector3d& point) const;
  /// Length of the texture around the solid and along it, metres.
  Eigen::Vector2d texture_size() const;
};

Panel operator*(const Se3& pose, const Panel& panel);
Solid operator*(const Se3& pose, const Solid& solid);

/// Smallest t > 0 at which t * direction lies on the shape (rays start at the origin), if any.
std::optional<double> intersect(const Panel& panel, const Eigen::Vector3d& direction);
std::optional<double> intersect(const Solid& solid, const Eigen::Vector3d& direction);

}  // namespace dkp_slam
