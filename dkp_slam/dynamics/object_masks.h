#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/compensation/object_tracker.h"
#include "dkp_slam/dynamics/masks/mask_cutter.h"
#include "dkp_slam/dynamics/masks/static_background.h"

namespace dkp_slam {

/// Cuts the mask of every object that moves by itself and drops carried ones that are not to be
/// found any more, or that are another one's double. `background` may be null; `grey` is the image,
/// CV_8UC1.
void cut_objects(const MaskCutter& cutter, const Scene& scene, StaticBackground* background,
                 const cv::Mat& grey, std::uint64_t seed, ObjectTracker& objects);

/// CV_8UC1 of the image's size: i + 1 in the mask of `tracker.objects()[i]`, near ones on top.
cv::Mat paint_labels(const ObjectTracker& tracker, const cv::Size& image);

}  // namespace dkp_slam
