#include "dkp_slam/detection/motion/coarse_grid.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {

CoarseGrid::CoarseGrid(const Camera& camera, int columns) : distortion_(camera.distortion) {
  step_ = std::max(1, static_cast<int>(std::lround(camera.width / static_cast<double>(columns))));
  size_ = {camera.width / step_, camera.height / step_};
  const auto step = static_cast<float>(step_);
  const float centre = 0.5F * (step - 1.0F);
  fx_ = static_cast<float>(camera.fx) / step;
  fy_ = static_cast<float>(camera.fy) / step;
  cx_ = (static_cast<float>(camera.cx) - centre) / step;
  cy_ = (static_cast<float>(camera.cy) - centre) / step;
  std::vector<cv::Point2f> centres;
  for (int v = 0; v < size_.height; ++v) {
    for (int u = 0; u < size_.width; ++u)
      centres.emplace_back(u * step + centre, v * step + centre);
  }
  rays_.reserve(centres.size());
  for (const cv::Point2f& p : camera.undistort(centres)) {
    rays_.emplace_back(camera.unproject({p.x, p.y}, 1.0).cast<float>());
  }
}

CoarseView CoarseGrid::view(const cv::Mat& grey, const cv::Mat& depth) const {
  CoarseView view;
  const cv::Rect used(0, 0, size_.width * step_, size_.height * step_);
  cv::resize(grey(used), view.grey, size_, 0, 0, cv::INTER_AREA);
  view.depth.create(size_, CV_32FC1);
  // Up to four pixels around the centre: the first known one counts.
  const int low = (step_ - 1) / 2, high = step_ / 2;
  for (int v = 0; v < size_.height; ++v) {
    const float* first = depth.ptr<float>(v * step_ + low);
    const float* second = depth.ptr<float>(v * step_ + high);
    float* out = view.depth.ptr<float>(v);
    for (int u = 0; u < size_.width; ++u) {
      const int left = u * step_ + low, right = u * step_ + high;
      float z = first[left];
      for (float other : {second[right], first[right], second[left]}) {
        if (!(z > 0.0F)) z = other;
      }
      out[u] = z > 0.0F ? z : 0.0F;
    }
  }
  return view;
}

cv::Point2f CoarseGrid::project(const Eigen::Vector3f& point) const {
  const float x = point.x() / point.z(), y = point.y() / point.z();
  if (distortion_.none()) return {fx_ * x + cx_, fy_ * y + cy_};
  const auto k1 = static_cast<float>(distortion_.k1), k2 = static_cast<float>(distortion_.k2);
  const auto k3 = static_cast<float>(distortion_.k3);
  const auto p1 = static_cast<float>(distortion_.p1), p2 = static_cast<float>(distortion_.p2);
  const float r2 = x * x + y * y;
  const float radial = 1.0F + r2 * (k1 + r2 * (k2 + r2 * k3));
  const float xd = x * radial + 2.0F * p1 * x * y + p2 * (r2 + 2.0F * x * x);
  const float yd = y * radial + p1 * (r2 + 2.0F * y * y) + 2.0F * p2 * x * y;
  return {fx_ * xd + cx_, fy_ * yd + cy_};
}

}  // namespace dkp_slam
