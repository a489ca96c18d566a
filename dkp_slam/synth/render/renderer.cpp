#include "dkp_slam/synth/render/renderer.h"

#include <mutex>
#include <optional>
#include <utility>

#include "dkp_slam/error.h"
#include "dkp_slam/synth/light/actor_light.h"
#include "dkp_slam/synth/light/light_map.h"
#include "dkp_slam/synth/render/edge_marks.h"
#include "dkp_slam/synth/render/frame_painter.h"
#include "dkp_slam/synth/render/shading.h"
#include "dkp_slam/synth/tracing/embree_scene.h"
#include "dkp_slam/synth/tracing/shutter.h"

namespace dkp_slam {

struct Renderer::Scene {
  Scene(Place place, std::vector<std::shared_ptr<const Actor>> actors, LampBrightness brightness_in)
      : embree(std::move(place.meshes), std::move(actors)),
        lamps(place.lamps),
        light(embree, lamps),
        brightness(std::move(brightness_in)) {}

  std::mutex mutex;  ///< the actors' place in `embree` belongs to one frame at a time
  EmbreeScene embree;
  Lamps lamps;
  LightMap light;
  LampBrightness brightness;
  std::optional<PixelRays> pixels;  ///< of the last camera
  FramePainter::Buffers buffers;
};

Renderer::Renderer(Place place, std::vector<std::shared_ptr<const Actor>> actors,
                   LampBrightness brightness)
    : scene_(std::make_unique<Scene>(std::move(place), std::move(actors), std::move(brightness))) {}

Renderer::~Renderer() = default;

Rendering Renderer::render(const Camera& camera,
                           const std::function<Se3(double)>& world_from_camera, double time,
                           const RenderOptions& options) const {
  if (const auto reason = camera.check()) throw Error("synthetic renderer: camera: " + *reason);
  if (options.samples < 1 || options.samples > EdgeMarks::most_samples) {
    throw Error("synthetic renderer: samples must be 1 to 16");
  }
  if (options.exposure < 0.0 || options.readout < 0.0) {
    throw Error("synthetic renderer: exposure and readout must be at least 0");
  }
  Scene& s = *scene_;
  const std::lock_guard lock(s.mutex);
  if (!s.pixels || !s.pixels->made_for(camera)) s.pixels.emplace(camera);
  const Shutter shutter(world_from_camera, camera.height, time, options.exposure, options.readout);
  s.embree.pose_actors(shutter.begin(), shutter.end());
  const ActorLight actor_light(s.embree, s.lamps, s.light,
                               shutter.row(camera.height / 2).middle.origin);
  const Shading shading(s.embree, s.light, actor_light);
  FramePainter painter({s.embree, s.lamps, shading}, camera, *s.pixels, shutter, s.brightness,
                       options.samples, &s.buffers);
  return painter.paint();
}

}  // namespace dkp_slam
