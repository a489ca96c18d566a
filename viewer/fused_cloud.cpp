#include "viewer/fused_cloud.h"

#include <cstdint>
#include <vector>

#include "dkp_slam/dense/surface_extraction.h"
#include "dkp_slam/error.h"
#include "viewer/container.h"

namespace dkp_slam::viewer {
namespace {

std::string packed(const SurfaceMesh& mesh, long version) {
  const std::size_t step = mesh.vertices.size() / FusedCloud::most_points + 1;
  std::vector<float> positions;
  std::vector<std::uint8_t> colours;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += step) {
    positions.insert(positions.end(), mesh.vertices[i].data(), mesh.vertices[i].data() + 3);
    colours.insert(colours.end(), mesh.colours[i].begin(), mesh.colours[i].end());
  }
  Container container;
  container.add("positions", positions);
  container.add("colours", colours);
  return container.finish({{"version", version}});
}

}  // namespace

std::shared_ptr<const std::string> FusedCloud::cloud(int map) {
  constexpr auto least_wait = std::chrono::seconds(2);
  const std::lock_guard lock(mutex_);
  const std::pair<int, long> wanted(map, map_->version());
  if (made_of_ == wanted || (made_of_.first == map && Clock::now() < next_)) return made_;
  std::shared_ptr<const std::string> made;
  try {
    map_->look(map, [&](const KeyframeFusion& fused) {
      made = std::make_shared<const std::string>(
          packed(extract_surface(fused.map(), {.least_views = SurfaceOptions::least_keyframes}),
                 wanted.second));
    });
  } catch (const Error&) {  // the fusing failed, which the run says itself
  }
  made_ = std::move(made);
  made_of_ = wanted;
  next_ = Clock::now() + least_wait;
  return made_;
}

}  // namespace dkp_slam::viewer
