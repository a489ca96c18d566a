#pragma once

#include <cstdint>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

/// Camera motions after those of the TUM benchmark's sequences.
enum class SyntheticMotion {
  xyz,         ///< along all three axes, looking ahead
  halfsphere,  ///< on a part of a sphere of about 2 m around the desk, looking at it
  still,       ///< held by hand: moves by a few millimetres
};

/// Pose world_from_camera at a time (seconds from 0) in the synthetic room. Smooth, starts at rest;
/// the seed changes its phases and speeds.
Se3 camera_pose(SyntheticMotion motion, std::uint64_t seed, double time);

}  // namespace dkp_slam
