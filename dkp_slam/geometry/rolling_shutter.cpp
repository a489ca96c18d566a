#include "dkp_slam/geometry/rolling_shutter.h"

#include <algorithm>

namespace dkp_slam {

ImagePoint at_middle_row(const Camera& camera, const ImagePoint& seen, float raw_row,
                         const Vector6d& velocity) {
  constexpr double far = 8.0;  // metres: what an indoor sensor gives no depth for is mostly far
  const double delay = row_delay(camera, static_cast<double>(raw_row));
  const double depth_delay = depth_row_delay(camera, static_cast<double>(raw_row));
  const bool known = seen.depth > 0.0F;
  const Eigen::Vector3d then =
      camera.unproject({seen.pixel.x, seen.pixel.y}, known ? static_cast<double>(seen.depth) : far);
  // First order in the delay: at 2 rad/s and 10 ms the second order is 0.1 px.
  const Eigen::Vector3d linear = velocity.head<3>(), turn = velocity.tail<3>();
  const Eigen::Vector3d rate = linear + turn.cross(then);
  const Eigen::Vector3d middle = then - delay * rate;
  const double depth = then.z() - depth_delay * rate.z();
  if (std::min(middle.z(), depth) < 0.5 * then.z()) return seen;
  const Eigen::Vector2d p = camera.project(middle);
  return {{static_cast<float>(p.x()), static_cast<float>(p.y())},
          known ? static_cast<float>(depth) : 0.0F};
}

}  // namespace dkp_slam
