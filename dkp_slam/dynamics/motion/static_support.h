#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/motion/feature_motion.h"
#include "dkp_slam/geometry/planes/depth_view.h"
#include "dkp_slam/geometry/planes/plane.h"

namespace dkp_slam {

/// 1 for every point (raw pixels) outside all boxes.
std::vector<std::uint8_t> outside_boxes(const std::vector<cv::Point2f>& points,
                                        const std::vector<cv::Rect2f>& boxes);

/// 1 for every point in a box or within `margin` pixels of one, and for `most` of the others that
/// have a depth (metres, as large as the image), evenly taken in the order given.
std::vector<std::uint8_t> thinned_outside(const std::vector<cv::Point2f>& points,
                                          const std::vector<cv::Rect2f>& boxes, float margin,
                                          const cv::Mat& depth, int most);

/// 1 for every point in a part of an image of `size` where of the points with a residual (pixels,
/// NaN for none) at least two and a third are above `moving`: there the others are worth a look.
std::vector<std::uint8_t> near_moving(const std::vector<cv::Point2f>& points,
                                      const std::vector<float>& residual, float moving,
                                      const cv::Size& size);

/// Flags points that lie on one of the static planes and run along it, camera frame, in boxes too:
/// where boxes leave too few points, the ego-motion rests on these as well.
void add_points_on_planes(const DepthView& view, const std::vector<cv::Point2f>& points,
                          const std::vector<Plane>& planes, const PlaneOptions& options,
                          std::vector<std::uint8_t>& flags);

/// Flags the points of `support` on planes larger than people, where the motion that the support
/// told leaves many of its points and half of these behind: somebody in a checked shirt has told
/// it, not the room. The same where they told none. `moving`: residual, pixels, from which a point
/// does not agree; `planes`: how planes are looked for. Empty where nothing speaks against it.
std::vector<std::uint8_t> planes_left_behind(const DepthView& view,
                                             const std::vector<cv::Point2f>& points,
                                             const std::vector<std::uint8_t>& support,
                                             const FeatureMotion& motion, float moving,
                                             const PlaneOptions& planes, std::uint64_t seed);

}  // namespace dkp_slam
