#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/synth/mesh/actor.h"
#include "dkp_slam/synth/room/furniture.h"

namespace dkp_slam {

/// The lamps' brightness at a time: 1 as built, 0 dark (a little light always comes in).
using LampBrightness = std::function<double(double time)>;

struct RenderOptions {
  double exposure = 0.0;  ///< seconds over which each row gathers light: motion blur
  double readout = 0.0;   ///< seconds from the first row's moment to the last's, around `time`
  int samples = 3;        ///< rays per pixel: edges and blur
};

/// What the camera sees, linear in light where it is colour, without sensor noise.
struct Rendering {
  cv::Mat radiance;  ///< CV_32FC3, BGR, linear; 1 is white paper under a lamp
  cv::Mat
      depth;  ///< CV_32FC1, metres along z, at the middle of the pixel and of the exposure; 0: none
  cv::Mat instance;  ///< CV_8UC1, 0 what stands still, i the i-th actor (from 1), at the same ray
};

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
