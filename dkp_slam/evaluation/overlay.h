#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/frame_dynamics.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

/// Picture of what the dynamics room found in a frame (CV_8UC3, BGR, the frame's size), after the
/// paper's Fig. 4: masks tinted red, boxes of objects (dashed when carried over a missed
/// detection) with their id, class and score, features as dots coloured by region (green low, blue
/// suspicious, red high), removed ones crossed out, and a legend with the counts. `dynamics` must
/// belong to `keypoints`; features may be empty (nothing was looked for), then all are drawn low.
cv::Mat draw_overlay(const RgbdFrame& frame, const std::vector<cv::KeyPoint>& keypoints,
                     const FrameDynamics& dynamics);

}  // namespace dkp_slam
