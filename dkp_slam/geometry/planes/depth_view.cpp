#include "dkp_slam/geometry/planes/depth_view.h"

#include <vector>

namespace dkp_slam {

cv::Mat depth_view_rays(const Camera& camera) {
  const int width = (camera.width + DepthView::step - 1) / DepthView::step;
  const int height = (camera.height + DepthView::step - 1) / DepthView::step;
  std::vector<cv::Point2f> raw;
  raw.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      raw.emplace_back(static_cast<float>(x * DepthView::step),
                       static_cast<float>(y * DepthView::step));
    }
  }
  const std::vector<cv::Point2f> flat = camera.undistort(raw);
  cv::Mat rays(height, width, CV_32FC2);
  std::size_t i = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x, ++i) {
      rays.at<cv::Vec2f>(y, x) = {static_cast<float>((flat[i].x - camera.cx) / camera.fx),
                                  static_cast<float>((flat[i].y - camera.cy) / camera.fy)};
    }
  }
  return rays;
}

DepthView make_depth_view(const cv::Mat& depth, const cv::Mat& rays) {
  DepthView view;
  view.rays = rays;
  view.depth.create(rays.size(), CV_32FC1);
  for (int y = 0; y < rays.rows; ++y) {
    const float* from = depth.ptr<float>(y * DepthView::step);
    float* to = view.depth.ptr<float>(y);
    for (int x = 0; x < rays.cols; ++x) to[x] = from[x * DepthView::step];
  }
  return view;
}

}  // namespace dkp_slam
