#include "dkp_slam/geometry/rolling_shutter.h"

namespace dkp_slam {

cv::Point2f at_middle_row(const Camera& camera, const cv::Point2f& pixel, float raw_row,
                          float depth, const Vector6d& velocity) {
  constexpr double far = 8.0;  // metres: what an indoor sensor gives no depth for is mostly far
  const double delay = row_delay(camera, static_cast<double>(raw_row));
  const Eigen::Vector3d seen =
      camera.unproject({pixel.x, pixel.y}, depth > 0.0F ? static_cast<double>(depth) : far);
  // First order in the delay: at 2 rad/s and 10 ms the second order is 0.1 px.
  const Eigen::Vector3d linear = velocity.head<3>(), turn = velocity.tail<3>();
  const Eigen::Vector3d then = seen - delay * (linear + turn.cross(seen));
  if (then.z() < 0.5 * seen.z()) return pixel;
  const Eigen::Vector2d p = camera.project(then);
  return {static_cast<float>(p.x()), static_cast<float>(p.y())};
}

}  // namespace dkp_slam
