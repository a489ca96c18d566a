#include "dkp_slam/geometry/depth_correction.h"

namespace dkp_slam {

DepthDistortion::Terms DepthDistortion::terms(const Eigen::Vector2d& pixel, const cv::Size& image) {
  const double x = 2.0 * pixel.x() / image.width - 1.0, y = 2.0 * pixel.y() / image.height - 1.0;
  Terms t;
  t << x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y;
  return t;
}

DepthCorrector::DepthCorrector(const DepthCorrection& correction, const cv::Size& size)
    : bias_(static_cast<float>(correction.bias)) {
  if (correction.distortion.none()) return;
  offset_.create(size);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      offset_(v, u) = static_cast<float>(
          correction.distortion.coefficients.dot(DepthDistortion::terms({u, v}, size)));
    }
  }
}

void DepthCorrector::apply(cv::Mat& depth) const {
  if (!offset_.empty()) {
    CV_Assert(depth.size() == offset_.size() && depth.type() == CV_32FC1);
    constexpr float least = 0.5F;
    for (int v = 0; v < depth.rows; ++v) {
      auto* const z = depth.ptr<float>(v);
      const auto* const offset = offset_.ptr<float>(v);
      for (int u = 0; u < depth.cols; ++u) {
        const float scale = 1.0F + offset[u] * z[u];
        const float corrected = z[u] / scale;  // always, so that several are taken at a time
        z[u] = scale > least ? corrected : 0.0F;
      }
    }
  }
  if (bias_ == 0.0F) return;
  const float bias = bias_;
  for (int v = 0; v < depth.rows; ++v) {
    auto* const z = depth.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u) z[u] += z[u] > 0.0F ? bias : 0.0F;
  }
}

}  // namespace dkp_slam
