#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/synth/mesh/actor.h"
#include "dkp_slam/synth/render/rendering.h"
#include "dkp_slam/synth/room/furniture.h"

namespace dkp_slam {

/// Traces rays through a place and its actors with Embree (Wald et al., SIGGRAPH 2014), textures
/// free of aliasing, soft shadows of the lamps. Same input, same bytes, on any number of threads.
class Renderer {
 public:
  Renderer(Place place, std::vector<std::shared_ptr<const Actor>> actors,
           LampBrightness brightness = nullptr);
  ~Renderer();

  /// `world_from_camera` gives the camera's pose at any time, seconds; the frame is that of `time`.
  /// `camera` may have lens distortion.
  Rendering render(const Camera& camera, const std::function<Se3(double)>& world_from_camera,
                   double time, const RenderOptions& options) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace dkp_slam
