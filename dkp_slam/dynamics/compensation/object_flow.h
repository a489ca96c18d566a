#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/motion/flow.h"

namespace dkp_slam {

/// Median flow (pixels since the frame before) of the dynamic points of each of `count` objects
/// (paper §3.3): the tracked points that lay in its mask. Nothing where they are too few. `points`
/// are raw pixels now, `labels` (CV_8UC1, i + 1 in object i's mask; may be empty) of the frame
/// before.
std::vector<std::optional<cv::Point2f>> object_flow(const std::vector<cv::Point2f>& points,
                                                    const FlowResult& tracks, const cv::Mat& labels,
                                                    std::size_t count);

/// Median of each coordinate; at least one vector.
cv::Point2f median_flow(std::vector<cv::Point2f> vectors);

}  // namespace dkp_slam
