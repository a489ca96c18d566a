#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/synth/light/actor_light.h"
#include "dkp_slam/synth/light/light_map.h"
#include "dkp_slam/synth/mesh/texture.h"
#include "dkp_slam/synth/tracing/embree_scene.h"

namespace dkp_slam {

/// The plane of a hit triangle, and how its texture lies on it.
struct HitPlane {
  Eigen::Vector3f point;   ///< metres, world frame
  Eigen::Vector3f normal;  ///< unit length, either side
  Eigen::Vector2f uv;
  Eigen::Vector3f gradient_u, gradient_v;  ///< change of u and v per metre along the plane
  Eigen::Vector3f travel = Eigen::Vector3f::Zero();  ///< of the point, from first to last light
};

/// Planes of hit triangles. Remembers the last triangle, which neighbouring rays often share: one
/// for each thread.
class HitPlanes {
 public:
  explicit HitPlanes(const EmbreeScene& scene) : scene_(scene) {}
  /// Good until the next call.
  const HitPlane& at(const SurfaceHit& hit, const Ray& ray);

 private:
  void look_up(int surface, int triangle);

  const EmbreeScene& scene_;
  int surface_ = -1, triangle_ = -1;
  HitPlane plane_;
  Eigen::Vector2f corner_uv_;                   ///< of the first corner
  Eigen::Vector2f along_first_, along_second_;  ///< changes of uv to the other two
};

/// What lies under a pixel: changes of uv to the pixel on the right, to the one below, and over
/// the exposure.
struct Footprint {
  Eigen::Vector2f right, down, motion;
};

/// `distance` and `direction` are the hit's and its ray's, `right` and `down` the changes of the
/// direction to the neighbouring pixels, in the world frame; `motion` is the way of the surface in
/// the image over the exposure, pixels.
Footprint footprint(const HitPlane& plane, float distance, const Eigen::Vector3f& direction,
                    const Eigen::Vector3f& right, const Eigen::Vector3f& down,
                    const Eigen::Vector2f& motion);

/// What is special about the light at one pixel.
struct PixelLight {
  float lamps = 1.0F;  ///< their brightness at its time
  float lost = 0.0F;   ///< of their direct light, to actors that stand in the way
};

/// Lights and textures of a scene at one time.
class Shading {
 public:
  Shading(const EmbreeScene& scene, const LightMap& still, const ActorLight& moving)
      : scene_(scene), still_(still), moving_(moving) {}

  /// What a pixel averages of a surface's texture.
  struct Filter {
    Texture::Filter texture;
    Eigen::Vector2f motion;  ///< change of uv over the exposure
    int taps;                ///< along it
  };
  /// Over the footprint alone, with up to `most_taps` across the view.
  Filter filter(int surface, const Footprint& footprint, int most_taps) const;
  /// Over the footprint and its way in the image over the exposure, pixels.
  Filter filter(int surface, const Footprint& footprint, const Eigen::Vector2f& way) const;
  /// Linear radiance, BGR.
  cv::Vec3f colour(const SurfaceHit& hit, const Eigen::Vector2f& uv, const Filter& filter,
                   const PixelLight& pixel) const;

 private:
  const EmbreeScene& scene_;
  const LightMap& still_;
  const ActorLight& moving_;
  const LinearLight linear_light_;
};

}  // namespace dkp_slam
