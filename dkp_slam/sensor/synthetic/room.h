#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/sensor/synthetic/shapes.h"

namespace dkp_slam {

/// Inner size of the synthetic room, metres: the origin lies on the floor, x is right, y is forward
/// (from the cameras' start to the desk), z is up.
struct RoomSize {
  double left = -2.7, right = 2.7, back = -2.4, front = 3.3, height = 2.7;
};

/// Walls with posters, carpet, ceiling, and furniture: a desk with two screens, a shelf with books,
/// a cabinet, a chair and boxes. Textures come from `rng`.
std::vector<Panel> build_room(cv::RNG& rng, const RoomSize& size = {});

}  // namespace dkp_slam
