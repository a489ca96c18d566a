#pragma once

namespace dkp_slam {

/// Metres along the camera's z: what is nearer, or behind it, makes no usable projection.
inline constexpr double nearest_depth = 0.05;

}  // namespace dkp_slam
