#include "dkp_slam/sensor/synthetic/texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

/// std::floor is a function call on processors of the oldest kind, which we build for.
int floor_to_int(float x) {
  const auto whole = static_cast<int>(x);
  return whole - (x < static_cast<float>(whole) ? 1 : 0);
}

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Short8 = std::int16_t __attribute__((vector_size(16)));
using Byte16 = std::uint8_t __attribute__((vector_size(16)));

/// The four bytes of a texel as numbers.
Float4 unpack(std::uint32_t texel) {
  const Int4 packed = {static_cast<std::int32_t>(texel), 0, 0, 0};
  const Byte16 no_bytes = {};
  const auto bytes = __builtin_shufflevector(std::bit_cast<Byte16>(packed), no_bytes, 0, 16, 1, 17,
                                             2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const Short8 no_shorts = {};
  const auto shorts =
      __builtin_shufflevector(std::bit_cast<Short8>(bytes), no_shorts, 0, 8, 1, 9, 2, 10, 3, 11);
  return __builtin_convertvector(std::bit_cast<Int4>(shorts), Float4);
}

/// Base-2 logarithm of a positive number, exact at powers of two, between them straight lines:
/// what a choice of pyramid levels needs, at a tenth of the price.
float rough_log2(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  return static_cast<float>(bits) * 0x1p-23F - 127.0F;
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
        level.texels.push_back(static_cast<std::uint32_t>(row[x][0]) |
                               static_cast<std::uint32_t>(row[x][1]) << 8U |
                               static_cast<std::uint32_t>(row[x][2]) << 16U);
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
  const Float4 last = unpack(levels_.back().texels.front());
  return {last[0], last[1], last[2]};
}

Texture::Float4 Texture::bilinear(const Level& level, const Eigen::Vector2f& uv) const {
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
  const std::uint32_t* upper = level.texels.data() + static_cast<std::ptrdiff_t>(y0) * level.width;
  const std::uint32_t* lower = level.texels.data() + static_cast<std::ptrdiff_t>(y1) * level.width;
  const Float4 top_left = unpack(upper[x0]), bottom_left = unpack(lower[x0]);
  const Float4 top = top_left + fx * (unpack(upper[x1]) - top_left);
  const Float4 bottom = bottom_left + fx * (unpack(lower[x1]) - bottom_left);
  return top + fy * (bottom - top);
}

cv::Vec3f Texture::sample(const Eigen::Vector2f& uv, const Eigen::Vector2f& du,
                          const Eigen::Vector2f& dv, int most_taps) const {
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
      std::clamp(rough_log2(std::max(longer / static_cast<float>(taps), 1.0F)), 0.0F, last_level);
  const auto fine = static_cast<std::size_t>(lod);
  // Half of the way between two levels one of them alone will do; all of it where few taps will.
  const float alone = most_taps > 2 ? 0.25F : 0.49F;
  const float share =
      std::clamp((lod - static_cast<float>(fine) - alone) / (1.0F - 2.0F * alone), 0.0F, 1.0F);
  const Level& level = levels_[share < 1.0F ? fine : fine + 1];
  const bool both = share > 0.0F && share < 1.0F;
  Float4 sum = {};
  for (int i = 0; i < taps; ++i) {
    const float along = (static_cast<float>(i) + 0.5F) / static_cast<float>(taps) - 0.5F;
    const Eigen::Vector2f at = uv + along * axis;
    Float4 colour = bilinear(level, at);
    if (both) colour += share * (bilinear(levels_[fine + 1], at) - colour);
    sum += colour;
  }
  sum *= 1.0F / static_cast<float>(taps);
  return {sum[0], sum[1], sum[2]};
}

float linear_light(float level) {
  // A table of 1/16 grey levels: the power function would take a third of the shading.
  constexpr int parts = 16;
  static const auto table = [] {
    std::array<float, 255 * parts + 1> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double c = static_cast<double>(i) / (255.0 * parts);
      values[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return values;
  }();
  return table[static_cast<std::size_t>(std::clamp(level, 0.0F, 255.0F) * parts + 0.5F)];
}

}  // namespace dkp_slam
