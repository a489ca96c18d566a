#pragma once

#include <array>
#include <functional>
#include <vector>

#include "dkp_slam/synth/figure/figure_skeleton.h"
#include "dkp_slam/synth/mesh/mesh.h"

namespace dkp_slam {

/// 0 below `from`, 1 above `to`, smooth in between.
double smooth_step(double value, double from, double to);

/// What moves a vertex: up to three joints, weights that sum to 1.
struct Influence {
  std::array<Joint, 3> joints = {Joint::pelvis, Joint::pelvis, Joint::pelvis};
  std::array<float, 3> weights = {1.0F, 0.0F, 0.0F};

  static Influence of(Joint joint) { return {{joint, joint, joint}, {1.0F, 0.0F, 0.0F}}; }
  /// `share` of `b`, the rest of `a`.
  static Influence of(Joint a, Joint b, double share) {
    const auto w = static_cast<float>(share);
    return {{a, b, a}, {1.0F - w, w, 0.0F}};
  }
};

/// A mesh that follows a skeleton: linear blend skinning (Magnenat-Thalmann et al. 1988).
struct SkinnedMesh {
  Mesh mesh;
  std::vector<Influence> influences;  ///< of each vertex
};

/// A cross section: a superellipse around the loft's axis.
struct Section {
  double along;        ///< coordinate on the axis, metres; sections run downwards
  double side;         ///< half width, metres
  double front;        ///< how far it reaches ahead, metres
  double back;         ///< and back
  double square;       ///< exponent: 2 an ellipse, more: squarer
  double shift = 0.0;  ///< of the middle, ahead
};

/// Sections in between, by monotone cubic interpolation (Fritsch and Carlson 1980): no overshoot.
Section section_at(const std::vector<Section>& sections, double along);

struct LoftShape {
  std::vector<Section> sections;
  int rows = 2, sides = 3;
  /// Sharpens the front: columns lie closer there by this share, below 1.
  double frontal = 0.0;
};

/// Angle from the front of the column at `u`, 0 to 1; u = 0.5 is the front.
double loft_angle(double u, double frontal);

/// The skin over sections along z; x is ahead. `place` puts it into the figure at rest; `bump`
/// moves points of the loft's own frame (angle from the front, point). Its texture goes once
/// around, the middle column in front, the top row at the first section.
SkinnedMesh loft(const LoftShape& shape, const Se3& place,
                 const std::function<Influence(const Eigen::Vector3d&)>& influence,
                 const std::function<Eigen::Vector3d(double, const Eigen::Vector3d&)>& bump = {});

/// The point of the skin at an angle from the front, before any bump.
Eigen::Vector3d section_point(const Section& section, double angle);

/// Normals of a grid of `rows` times `sides` + 1 vertices whose last column repeats the first.
void compute_grid_normals(Mesh& mesh, int rows, int sides);
/// Triangles of such a grid, rows running downwards, columns counter-clockwise seen from above.
void add_grid_triangles(Mesh& mesh, int rows, int sides);

/// Adds a part of the same texture.
void append(const SkinnedMesh& part, SkinnedMesh& whole);

}  // namespace dkp_slam
