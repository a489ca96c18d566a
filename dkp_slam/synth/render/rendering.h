#pragma once

#include <functional>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// The lamps' brightness at a time: 1 as built, 0 dark (a little light always comes in).
using LampBrightness = std::function<double(double time)>;

struct RenderOptions {
  double exposure = 0.0;  ///< seconds over which each row gathers light: motion blur
  double readout = 0.0;   ///< seconds from the first row's moment to the last's, around `time`
  int samples = 3;        ///< rays per pixel: edges and blur
};

/// What the camera sees, linear in light where it is colour, without sensor noise.
struct Rendering {
  cv::Mat radiance;  ///< CV_32FC3, BGR, linear; 1 is white paper under a lamp
  cv::Mat
      depth;  ///< CV_32FC1, metres along z, at the middle of the pixel and of the exposure; 0: none
  cv::Mat instance;  ///< CV_8UC1, 0 what stands still, i the i-th actor (from 1), at the same ray
};

}  // namespace dkp_slam
