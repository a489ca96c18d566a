#include "dkp_slam/system/usable_detections.h"

#include <algorithm>
#include <cmath>

namespace dkp_slam {
namespace {

bool is_number(const Detection& d) {
  // A side that is infinite, or a sum that overflows, has no right end.
  return std::isfinite(d.box.x + d.box.width) && std::isfinite(d.box.y + d.box.height) &&
         std::isfinite(d.box.x) && std::isfinite(d.box.y) && d.score >= 0.0F && d.score <= 1.0F &&
         d.weight >= 1.0F && d.weight <= 10.0F;
}

}  // namespace

std::vector<Detection> usable_detections(std::vector<Detection> detections, const cv::Size& image) {
  const cv::Rect2f whole(0.0F, 0.0F, static_cast<float>(image.width),
                         static_cast<float>(image.height));
  std::erase_if(detections, [&](Detection& d) {
    if (!is_number(d)) return true;
    const cv::Rect2f clipped = d.box & whole;
    // Clipping is not exact: a box inside of the image stays as it is, to the last bit.
    const bool inside = d.box.x >= 0.0F && d.box.y >= 0.0F && d.box.br().x <= whole.width &&
                        d.box.br().y <= whole.height;
    if (d.mask.type() != CV_8UC1 || clipped.tl() != d.box.tl()) d.mask.release();
    if (!inside) d.box = clipped;
    return clipped.empty();
  });
  return detections;
}

}  // namespace dkp_slam
