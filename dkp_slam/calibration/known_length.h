#pragma once

#include <array>
#include <string>

#include <Eigen/Core>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/sensor/rgbd_source.h"

namespace dkp_slam {

/// Two points of one image whose distance somebody measured.
struct KnownLength {
  double timestamp = 0.0;                 ///< seconds, of the colour image
  std::array<Eigen::Vector2d, 2> pixels;  ///< raw, each on a flat surface
  double metres = 0.0;
};

/// Reads "TIMESTAMP,u1,v1,u2,v2,METRES". Throws `Error` that says what is wrong.
KnownLength parse_known_length(const std::string& text);

/// What the depth images make of a known length.
struct MeasuredLength {
  double metres = 0.0;
  double sigma = 0.0;  ///< standard deviation, with that of pixels picked by hand, half a pixel
  int frames = 0;      ///< that saw both ends
};

/// The distance of the two points by the depth of all frames within half a second, which the path
/// brings together. Throws `Error` when there is no such image on the path, or too few frames with
/// flat depth at both ends.
MeasuredLength measure_length(const KnownLength& length, RgbdSource& source, const Camera& camera,
                              const Trajectory& path);

}  // namespace dkp_slam
