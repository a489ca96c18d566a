#include "dkp_slam/sensor/synthetic/texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

// More than this many taps only matter on floors seen at a few degrees.
constexpr int most_taps = 6;

}  // namespace

Texture::Texture(const cv::Mat& bgr, bool wrap) : wrap_(wrap) {
  CV_Assert(bgr.type() == CV_8UC3 && !bgr.empty());
  levels_.push_back(bgr.clone());
  while (levels_.back().cols > 1 || levels_.back().rows > 1) {
    const cv::Mat& last = levels_.back();
    cv::Mat half;
    cv::resize(last, half, cv::Size(std::max(last.cols / 2, 1), std::max(last.rows / 2, 1)), 0, 0,
               cv::INTER_AREA);
    levels_.push_back(half);
  }
}

cv::Vec3f Texture::bilinear(int level, const Eigen::Vector2d& uv) const {
  const cv::Mat& image = levels_[static_cast<std::size_t>(level)];
  const double x = uv.x() * image.cols - 0.5;
  const double y = std::clamp(uv.y() * image.rows - 0.5, 0.0, image.rows - 1.0);
  const double floor_x = std::floor(x);
  const auto fx = static_cast<float>(x - floor_x);
  int x0 = static_cast<int>(floor_x), x1 = x0 + 1;
  if (wrap_) {
    x0 = (x0 % image.cols + image.cols) % image.cols;
    x1 = (x1 % image.cols + image.cols) % image.cols;
  } else {
    x0 = std::clamp(x0, 0, image.cols - 1);
    x1 = std::clamp(x1, 0, image.cols - 1);
  }
  const int y0 = static_cast<int>(y), y1 = std::min(y0 + 1, image.rows - 1);
  const auto fy = static_cast<float>(y - y0);
  const auto* upper = image.ptr<cv::Vec3b>(y0);
  const auto* lower = image.ptr<cv::Vec3b>(y1);
  cv::Vec3f result;
  for (int c = 0; c < 3; ++c) {
    const float top = upper[x0][c] + fx * static_cast<float>(upper[x1][c] - upper[x0][c]);
    const float bottom = lower[x0][c] + fx * static_cast<float>(lower[x1][c] - lower[x0][c]);
    result[c] = top + fy * (bottom - top);
  }
  return result;
}

cv::Vec3f Texture::sample(const Eigen::Vector2d& uv, const Eigen::Vector2d& du,
                          const Eigen::Vector2d& dv) const {
  const Eigen::Array2d texels(levels_[0].cols, levels_[0].rows);
  double longer = (du.array() * texels).matrix().norm();
  double shorter = (dv.array() * texels).matrix().norm();
  Eigen::Vector2d axis = du;
  if (shorter > longer) {
    std::swap(shorter, longer);
    axis = dv;
  }
  const int taps =
      std::clamp(static_cast<int>(std::ceil(longer / std::max(shorter, 1.0))), 1, most_taps);
  const double last_level = static_cast<double>(levels_.size() - 1);
  const double lod = std::clamp(std::log2(std::max(longer / taps, 1e-6)), 0.0, last_level);
  const int fine = static_cast<int>(lod);
  const auto share = static_cast<float>(lod - fine);
  cv::Vec3f sum(0.0F, 0.0F, 0.0F);
  for (int i = 0; i < taps; ++i) {
    const Eigen::Vector2d at = uv + ((i + 0.5) / taps - 0.5) * axis;
    cv::Vec3f colour = bilinear(fine, at);
    if (share > 0.0F) colour += share * (bilinear(fine + 1, at) - colour);
    sum += colour;
  }
  return sum * (1.0F / static_cast<float>(taps));
}

}  // namespace dkp_slam
