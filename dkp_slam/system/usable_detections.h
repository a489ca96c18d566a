#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/detection/detector.h"

namespace dkp_slam {

/// What of a detector's answer is a detection in an image of this size. A detector is anybody's
/// code, and what follows computes with its numbers: boxes are clipped to the image; those outside
/// of it or of no finite size go, as do scores that are no probabilities and weights that are none
/// from 1 to 10; a silhouette that is no CV_8UC1 image or begins outside of the image goes, and its
/// box stays.
std::vector<Detection> usable_detections(std::vector<Detection> detections, const cv::Size& image);

}  // namespace dkp_slam
