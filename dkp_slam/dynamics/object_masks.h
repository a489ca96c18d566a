#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/compensation/object_tracker.h"
#include "dkp_slam/dynamics/masks/mask_cutter.h"
#include "dkp_slam/dynamics/masks/static_background.h"
#include "dkp_slam/dynamics/motion/feature_motion.h"

namespace dkp_slam {

/// Cuts the mask of every object that moves by itself and drops carried ones that are not to be
/// found any more, or that are another one's double. `background` may be null; `grey` is the image,
/// CV_8UC1.
void cut_objects(const MaskCutter& cutter, const Scene& scene, StaticBackground* background,
                 const cv::Mat& grey, std::uint64_t seed, ObjectTracker& objects);

/// Objects move by themselves whose silhouette the detector did not tell.
bool any_to_cut(const ObjectTracker& objects);
/// CV_8UC1, image size, 1 in the masks that `cut_objects` would cut of those; changes no object.
cv::Mat cut_from(const MaskCutter& cutter, const Scene& scene, StaticBackground* background,
                 const cv::Mat& grey, std::uint64_t seed, const ObjectTracker& objects);

/// Flags points in boxes of named objects that no mask of the frame before held (`labels_before`,
/// image size, CV_8UC1, 0 for none; may be empty) and that the motion that was measured leaves at
/// most `most` pixels off. In boxes of others, or of those that had no mask, there may be people.
std::vector<std::uint8_t> unmasked(const FeatureMotion& motion,
                                   const std::vector<cv::Point2f>& points,
                                   const std::vector<ObjectTracker::Tracked>& objects,
                                   const cv::Mat& labels_before, double most);

/// CV_8UC1 of the image's size: i + 1 in the mask of `tracker.objects()[i]`, near ones on top.
cv::Mat paint_labels(const ObjectTracker& tracker, const cv::Size& image);

}  // namespace dkp_slam
