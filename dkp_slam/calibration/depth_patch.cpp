#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "dkp_slam/calibration/sightings.h"
#include "dkp_slam/geometry/sensor_scale.h"

namespace dkp_slam {
namespace {

constexpr int half_width = 7;  // pixels of an image 640 wide
constexpr int stride = 2;      // neighbouring readings share their noise
constexpr double known_share = 0.7;
constexpr double most_sigmas = 2.0;  // of the plane's residuals, of the sensor's noise
constexpr double rounding = 0.0015;  // 1/metre: an eighth of a Kinect's disparity step, and more

struct Reading {
  Eigen::Vector3d place;  // 1, and pixels from the middle
  double inverse;         // 1/metre
};

std::vector<Reading> readings_around(const cv::Mat& depth, int half, int u, int v) {
  std::vector<Reading> readings;
  for (int dv = -half; dv <= half; dv += stride) {
    const auto* row = depth.ptr<float>(v + dv);
    for (int du = -half; du <= half; du += stride) {
      const double z = row[u + du];
      if (z > 0.0) readings.push_back({{1.0, double(du), double(dv)}, 1.0 / z});
    }
  }
  return readings;
}

}  // namespace

DepthPatch fit_depth_patch(const cv::Mat& depth, const Camera& camera,
                           const Eigen::Vector2d& pixel) {
  const int half =
      std::max(3, static_cast<int>(std::lround(half_width * SensorScale::of(camera).pixels)));
  const int u = static_cast<int>(std::lround(pixel.x()));
  const int v = static_cast<int>(std::lround(pixel.y()));
  if (u < half || v < half || u + half >= depth.cols || v + half >= depth.rows) return {};
  const std::vector<Reading> readings = readings_around(depth, half, u, v);
  const int side = half / stride * 2 + 1;
  if (static_cast<double>(readings.size()) < known_share * side * side) return {};
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const Reading& r : readings) {
    h += r.place * r.place.transpose();
    b += r.place * r.inverse;
  }
  const Eigen::Vector3d plane = h.ldlt().solve(b);
  if (!plane.allFinite() || plane[0] <= 0.0) return {};
  const double z = 1.0 / plane[0];
  const double noise = camera.depth_noise.sigma(z) / (z * z) + rounding;
  double squares = 0.0;
  for (const Reading& r : readings) {
    const double error = plane.dot(r.place) - r.inverse;
    if (std::abs(error) > 3.0 * most_sigmas * noise) return {};
    squares += error * error;
  }
  if (std::sqrt(squares / static_cast<double>(readings.size())) > most_sigmas * noise) return {};
  DepthPatch patch;
  patch.pixel = {double(u), double(v)};
  patch.inverse = plane[0];
  patch.slope = plane.tail<2>();
  return patch;
}

}  // namespace dkp_slam
