#pragma once

#include <opencv2/core.hpp>

#include "dkp_slam/synth/figure/figure_look.h"

namespace dkp_slam {

/// CV_8UC3 paintings for the meshes of `figure_head` and `figure_hands`.
cv::Mat paint_head(cv::RNG& rng, const FigureLook& look);
cv::Mat paint_hair(cv::RNG& rng, const FigureLook& look);
cv::Mat paint_skin(cv::RNG& rng, const FigureLook& look);

}  // namespace dkp_slam
