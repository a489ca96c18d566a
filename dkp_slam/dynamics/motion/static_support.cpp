#include "dkp_slam/dynamics/motion/static_support.h"

#include <algorithm>

namespace dkp_slam {

std::vector<std::uint8_t> outside_boxes(const std::vector<cv::Point2f>& points,
                                        const std::vector<cv::Rect2f>& boxes) {
  std::vector<std::uint8_t> outside(points.size(), 1);
  for (const cv::Rect2f& box : boxes) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (box.contains(points[i])) outside[i] = 0;
    }
  }
  return outside;
}

void add_points_on_planes(const DepthView& view, const std::vector<cv::Point2f>& points,
                          const std::vector<Plane>& planes, const PlaneOptions& options,
                          std::vector<std::uint8_t>& flags) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point at(std::clamp(cvRound(points[i].x) / DepthView::step, 0, view.depth.cols - 1),
                       std::clamp(cvRound(points[i].y) / DepthView::step, 0, view.depth.rows - 1));
    for (const Plane& plane : planes) {
      if (flags[i] == 0 && runs_along(view, plane, at.x, at.y, options)) flags[i] = 1;
    }
  }
}

}  // namespace dkp_slam
