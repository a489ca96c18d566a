#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/masks/depth_view.h"
#include "dkp_slam/dynamics/masks/plane.h"

namespace dkp_slam {

/// 1 for every point (raw pixels) outside all boxes.
std::vector<std::uint8_t> outside_boxes(const std::vector<cv::Point2f>& points,
                                        const std::vector<cv::Rect2f>& boxes);

/// Flags points that lie on one of the static planes and run along it, camera frame, in boxes too:
/// where boxes leave too few points, the ego-motion rests on these as well.
void add_points_on_planes(const DepthView& view, const std::vector<cv::Point2f>& points,
                          const std::vector<Plane>& planes, const PlaneOptions& options,
                          std::vector<std::uint8_t>& flags);

}  // namespace dkp_slam
