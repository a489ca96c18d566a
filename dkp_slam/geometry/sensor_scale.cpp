#include "dkp_slam/geometry/sensor_scale.h"

#include <algorithm>
#include <cmath>

namespace dkp_slam {

SensorScale SensorScale::of(const Camera& camera) {
  return {camera.width / 640.0, camera.frame_rate / 30.0};
}

int SensorScale::frames_of(int at_30_hz) const {
  return std::max(1, static_cast<int>(std::lround(at_30_hz * frames)));
}

Camera resized(const Camera& camera, int width, int height) {
  Camera other = camera;
  const double scale = static_cast<double>(width) / camera.width;
  other.width = width;
  other.height = height;
  other.fx *= scale;
  other.fy *= scale;
  // Pixel centres have whole coordinates, so that the image begins at -0.5.
  other.cx = (camera.cx + 0.5) * scale - 0.5;
  other.cy = (camera.cy + 0.5) * scale - 0.5 + 0.5 * (height - camera.height * scale);
  return other;
}

}  // namespace dkp_slam
