#include "dkp_slam/detection/motion/coarse_grid.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {

RowMotion::RowMotion(double readout, const Vector6d& velocity)
    : shift_((readout * velocity.head<3>()).cast<float>()),
      turn_((readout * velocity.tail<3>()).cast<float>()) {}

CoarseGrid::CoarseGrid(const Camera& camera, int columns)
    : k1_(static_cast<float>(camera.distortion.k1)),
      k2_(static_cast<float>(camera.distortion.k2)),
      k3_(static_cast<float>(camera.distortion.k3)),
      p1_(static_cast<float>(camera.distortion.p1)),
      p2_(static_cast<float>(camera.distortion.p2)) {
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

}  // namespace dkp_slam
