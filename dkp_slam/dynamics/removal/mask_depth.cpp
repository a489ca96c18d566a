#include "dkp_slam/dynamics/removal/mask_depth.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "dkp_slam/dynamics/removal/regions.h"

namespace dkp_slam {

MaskDepth::MaskDepth(int reach, double tolerance)
    : reach_(reach), tolerance_(static_cast<float>(tolerance)) {
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      if (x * x + y * y <= reach * reach) offsets_.emplace_back(x, y);
    }
  }
  std::stable_sort(offsets_.begin(), offsets_.end(),
                   [](const cv::Point& a, const cv::Point& b) { return a.dot(a) < b.dot(b); });
}

cv::Mat MaskDepth::candidates(const cv::Mat& masks) const {
  return masks_and_outlines(masks, reach_);
}

bool MaskDepth::is_shared(const cv::Mat& masks, const cv::Mat& depth, cv::Point pixel) const {
  const float own = depth.at<float>(pixel);
  if (!(own > 0.0F)) return false;
  const cv::Rect image({}, masks.size());
  for (const cv::Point& offset : offsets_) {
    const cv::Point p = pixel + offset;
    if (!image.contains(p) || masks.at<std::uint8_t>(p) == 0) continue;
    const float there = depth.at<float>(p);
    if (there > 0.0F) return std::abs(there - own) <= tolerance_ * own;
  }
  return false;
}

}  // namespace dkp_slam
