#pragma once

#include <vector>

#include <Eigen/Core>

#include "dkp_slam/synth/tracing/embree_scene.h"

namespace dkp_slam {

/// Light that falls on a surface; 1 makes a white one as bright as paper under a lamp. The first
/// three: blue, green, red of the lamps, with what walls and furniture reflect; the last: what is
/// there without them (windows, screens).
using Light = Eigen::Vector4f;

constexpr float without_lamps = 0.03F;  ///< light that always comes in
constexpr float more_bounces = 1.35F;   ///< 1 / (1 - what an office reflects, about a quarter)
/// Of a place without lamps: the same everywhere, 1 in all.
Light plain_light();

/// Lamps of a place: panels of 60 x 60 cm that shine downwards.
class Lamps {
 public:
  explicit Lamps(const std::vector<Eigen::Vector3d>& places);

  bool none() const { return places_.empty(); }
  int count() const { return static_cast<int>(places_.size()); }
  /// Middle of a lamp, metres, world frame.
  const Eigen::Vector3f& place(int lamp) const { return places_[static_cast<std::size_t>(lamp)]; }
  /// What an unshaded lamp gives to a surface.
  float strength(int lamp, const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const;
  /// Ray from a point just above a surface to place (a, b), each -1..1, on a lamp.
  Ray towards(int lamp, const Eigen::Vector3f& point, float a, float b) const;

 private:
  std::vector<Eigen::Vector3f> places_;
};

/// Light on everything that stands still, computed once: direct light of the lamps with soft
/// shadows on a grid of some centimetres, and one bounce gathered over the half space (as in
/// Cohen and Wallace, "Radiosity and Realistic Image Synthesis", 1993, Section 8), further bounces
/// as a factor.
class LightMap {
 public:
  LightMap(const EmbreeScene& scene, const Lamps& lamps);

  /// On a surface that stands still.
  Light at(const SurfaceHit& hit) const;
  /// What a surface that stands still sends back, the texture's mean colour; at full lamps.
  Light reflected(const SurfaceHit& hit) const;

 private:
  struct Point {
    Eigen::Vector3f position, normal;
  };
  /// Light points of a triangle: `steps` intervals along its edges from the first corner, from
  /// `first` on, row by row along v; with 0 steps the mesh's own vertices, `first` the mesh's.
  struct Patch {
    int first = 0, steps = 0;
  };

  void lay_out(std::vector<Point>* points);
  void shine(const Lamps& lamps, const std::vector<Point>& points);
  void bounce(const std::vector<Point>& points);
  Light gather(const Point& point) const;

  const EmbreeScene& scene_;
  std::vector<int> first_patch_;  ///< of each surface
  std::vector<Patch> patches_;    ///< of each triangle
  std::vector<Light> lights_;     ///< of each point
  std::vector<Light> albedos_;    ///< of each surface: mean blue, green, red, grey
};

}  // namespace dkp_slam
