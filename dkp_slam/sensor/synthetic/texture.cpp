#include "dkp_slam/sensor/synthetic/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

// More than this many taps only matter on floors seen at a few degrees.
constexpr int most_taps = 6;

/// std::floor is a function call on processors of the oldest kind, which we build for.
int floor_to_int(float x) {
  const auto whole = static_cast<int>(x);
  return whole - (x < static_cast<float>(whole) ? 1 : 0);
}

}  // namespace

Texture::Texture(const cv::Mat& bgr, bool wrap) : wrap_(wrap) {
  CV_Assert(bgr.type() == CV_8UC3 && !bgr.empty());
  cv::Mat image = bgr.clone();
  while (true) {
    Level level{image.cols, image.rows, {}};
    level.texels.reserve(static_cast<std::size_t>(image.cols) * image.rows);
    for (int y = 0; y < image.rows; ++y) {
      const auto* row = image.ptr<cv::Vec3b>(y);
      for (int x = 0; x < image.cols; ++x) {
        level.texels.emplace_back(row[x][0], row[x][1], row[x][2], std::uint8_t{0});
      }
    }
    levels_.push_back(std::move(level));
    if (image.cols == 1 && image.rows == 1) break;
    cv::Mat half;
    cv::resize(image, half, cv::Size(std::max(image.cols / 2, 1), std::max(image.rows / 2, 1)), 0,
               0, cv::INTER_AREA);
    image = half;
  }
}

cv::Vec3f Texture::mean() const {
  const cv::Vec4b& last = levels_.back().texels.front();
  return {static_cast<float>(last[0]), static_cast<float>(last[1]), static_cast<float>(last[2])};
}

cv::Vec3f Texture::bilinear(const Level& level, const Eigen::Vector2f& uv) const {
  const float x = uv.x() * static_cast<float>(level.width) - 0.5F;
  const float y = std::clamp(uv.y() * static_cast<float>(level.height) - 0.5F, 0.0F,
                             static_cast<float>(level.height - 1));
  int x0 = floor_to_int(x), x1 = x0 + 1;
  const float fx = x - static_cast<float>(x0);
  if (wrap_) {
    x0 = (x0 % level.width + level.width) % level.width;
    x1 = (x1 % level.width + level.width) % level.width;
  } else {
    x0 = std::clamp(x0, 0, level.width - 1);
    x1 = std::clamp(x1, 0, level.width - 1);
  }
  const int y0 = static_cast<int>(y), y1 = std::min(y0 + 1, level.height - 1);
  const float fy = y - static_cast<float>(y0);
  const cv::Vec4b* upper = level.texels.data() + static_cast<std::ptrdiff_t>(y0) * level.width;
  const cv::Vec4b* lower = level.texels.data() + static_cast<std::ptrdiff_t>(y1) * level.width;
  cv::Vec3f result;
  for (int c = 0; c < 3; ++c) {
    const float top = upper[x0][c] + fx * static_cast<float>(upper[x1][c] - upper[x0][c]);
    const float bottom = lower[x0][c] + fx * static_cast<float>(lower[x1][c] - lower[x0][c]);
    result[c] = top + fy * (bottom - top);
  }
  return result;
}

cv::Vec3f Texture::sample(const Eigen::Vector2f& uv, const Eigen::Vector2f& du,
                          const Eigen::Vector2f& dv) const {
  const Eigen::Array2f texels(static_cast<float>(levels_[0].width),
                              static_cast<float>(levels_[0].height));
  float longer = (du.array() * texels).matrix().norm();
  float shorter = (dv.array() * texels).matrix().norm();
  Eigen::Vector2f axis = du;
  if (shorter > longer) {
    std::swap(shorter, longer);
    axis = dv;
  }
  // Compared before the conversion: at grazing angles the ratio is beyond what an int holds.
  const float ratio = std::min(longer / std::max(shorter, 1.0F), static_cast<float>(most_taps));
  const int taps = std::max(static_cast<int>(std::ceil(ratio)), 1);
  const auto last_level = static_cast<float>(levels_.size() - 1);
  const float lod =
      std::clamp(std::log2(std::max(longer / static_cast<float>(taps), 1e-6F)), 0.0F, last_level);
  const auto fine = static_cast<std::size_t>(lod);
  const float share = lod - static_cast<float>(fine);
  cv::Vec3f sum(0.0F, 0.0F, 0.0F);
  for (int i = 0; i < taps; ++i) {
    const float along = (static_cast<float>(i) + 0.5F) / static_cast<float>(taps) - 0.5F;
    const Eigen::Vector2f at = uv + along * axis;
    cv::Vec3f colour = bilinear(levels_[fine], at);
    if (share > 0.0F) colour += share * (bilinear(levels_[fine + 1], at) - colour);
    sum += colour;
  }
  return sum * (1.0F / static_cast<float>(taps));
}

float linear_light(float level) {
  // A table of 1/8 grey levels: the power function would take a third of the shading.
  static const auto table = [] {
    std::array<float, 255 * 8 + 2> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double c = static_cast<double>(i) / (255.0 * 8.0);
      values[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return values;
  }();
  const float x = std::clamp(level, 0.0F, 255.0F) * 8.0F;
  const auto i = static_cast<std::size_t>(x);
  const float share = x - static_cast<float>(i);
  return table[i] + share * (table[i + 1] - table[i]);
}

}  // namespace dkp_slam
