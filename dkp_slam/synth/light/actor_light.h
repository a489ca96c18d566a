#pragma once

#include <array>
#include <vector>

#include "dkp_slam/synth/light/light_map.h"
#include "dkp_slam/synth/tracing/embree_scene.h"

namespace dkp_slam {

/// Light on the vertices of the actors' meshes at the middle of a frame: the lamps', with shadows
/// of everything, and what the place around each actor reflects.
class ActorLight {
 public:
  /// For a camera near `eye`: what faces away from it gets no light of the lamps.
  ActorLight(const EmbreeScene& scene, const Lamps& lamps, const LightMap& map,
             const Eigen::Vector3f& eye);
  /// On an actor's surface.
  Light at(const SurfaceHit& hit) const;

 private:
  /// Light from the directions +x, -x, +y, -y, +z, -z ("ambient cube": McTaggart, "Half-Life 2 /
  /// Valve Source Shading", GDC 2004).
  using Cube = std::array<Light, 6>;

  Cube around(int instance) const;
  void shine(const Lamps& lamps, const Surface& surface, const Cube& cube,
             const std::vector<int>& vertices, std::vector<Light>* lights) const;

  const EmbreeScene& scene_;
  const LightMap& map_;
  std::vector<std::vector<Light>> vertices_;  ///< of each moving surface
};

/// Direct light that actors keep from a point on what stands still, as `Light` counts it.
float light_lost_to_actors(const EmbreeScene& scene, const Lamps& lamps,
                           const Eigen::Vector3f& point, const Eigen::Vector3f& normal);

}  // namespace dkp_slam
