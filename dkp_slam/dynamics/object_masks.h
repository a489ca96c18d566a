#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/compensation/object_tracker.h"
#include "dkp_slam/dynamics/masks/mask_cutter.h"

namespace dkp_slam {

/// Cuts the mask of every object that moves by itself and drops carried ones that are not to be
/// found any more, or that are another one's double.
void cut_objects(const MaskCutter& cutter, const Scene& scene, std::uint64_t seed,
                 ObjectTracker& objects);

/// CV_8UC1 of the image's size: i + 1 in the mask of `tracker.objects()[i]`, near ones on top.
cv::Mat paint_labels(const ObjectTracker& tracker, const cv::Size& image);

}  // namespace dkp_slam
