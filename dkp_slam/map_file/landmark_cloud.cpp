#include "dkp_slam/map_file/landmark_cloud.h"

#include <iterator>

#include <fmt/format.h>

namespace dkp_slam {

int map_of_landmark(const Map& map, int landmark) {
  return map.keyframe(map.landmark(landmark).sightings.front().keyframe).map;
}

std::string landmarks_ply(const Map& map) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment metres, world frame of each map\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\nproperty int map\nend_header\n",
      map.live_landmarks());
  for (const int l : map.landmarks()) {
    const Eigen::Vector3d& p = map.landmark(l).position;
    fmt::format_to(std::back_inserter(text), "{:.6f} {:.6f} {:.6f} {}\n", p.x(), p.y(), p.z(),
                   map_of_landmark(map, l));
  }
  return text;
}

}  // namespace dkp_slam
