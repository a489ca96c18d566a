#include "dkp_slam/synth/mesh/texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

/// As std::clamp, but without branches.
float limit(float x, float low, float high) {
  x = x < low ? low : x;
  return x > high ? high : x;
}

/// std::floor is a function call on processors of the oldest kind, which we build for.
int floor_to_int(float x) {
  const auto whole = static_cast<int>(x);
  return whole - (x < static_cast<float>(whole) ? 1 : 0);
}

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Byte16 = std::uint8_t __attribute__((vector_size(16)));

using UShort8 = std::uint16_t __attribute__((vector_size(16)));
using Long2 = std::uint64_t __attribute__((vector_size(16)));

/// The bytes of a texel and of its right neighbour as numbers.
UShort8 unpack(const std::uint32_t* texels) {
  std::uint64_t both;
  std::memcpy(&both, texels, sizeof(both));
  const Long2 packed = {both, 0};
  const Byte16 no_bytes = {};
  return std::bit_cast<UShort8>(__builtin_shufflevector(std::bit_cast<Byte16>(packed), no_bytes, 0,
                                                        16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6,
                                                        22, 7, 23));
}

/// The first and the second four of eight numbers.
Float4 first_half(UShort8 values) {
  const UShort8 zeros = {};
  return __builtin_convertvector(
      std::bit_cast<Int4>(__builtin_shufflevector(values, zeros, 0, 8, 1, 9, 2, 10, 3, 11)),
      Float4);
}
Float4 second_half(UShort8 values) {
  const UShort8 zeros = {};
  return __builtin_convertvector(
      std::bit_cast<Int4>(__builtin_shufflevector(values, zeros, 4, 12, 5, 13, 6, 14, 7, 15)),
      Float4);
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
    level.texels.reserve(static_cast<std::size_t>(image.cols + 1) * image.rows);
    for (int y = 0; y < image.rows; ++y) {
      const auto* row = image.ptr<cv::Vec3b>(y);
      for (int x = 0; x < image.cols; ++x) {
        level.texels.push_back(static_cast<std::uint32_t>(row[x][0]) |
                               static_cast<std::uint32_t>(row[x][1]) << 8U |
                               static_cast<std::uint32_t>(row[x][2]) << 16U);
      }
      const std::size_t first = level.texels.size() - static_cast<std::size_t>(image.cols);
      level.texels.push_back(wrap ? level.texels[first] : level.texels.back());
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
  const Float4 last = first_half(unpack(levels_.back().texels.data()));
  return {last[0], last[1], last[2]};
}

Texture::Float4 Texture::bilinear(const Level& level, float u, float v) const {
  const auto last_column = static_cast<float>(level.width - 1);
  const auto last_row = static_cast<float>(level.height - 1);
  float x = u * static_cast<float>(level.width) - 0.5F;
  const float y = limit(v * static_cast<float>(level.height) - 0.5F, 0.0F, last_row);
  if (!wrap_) x = limit(x, 0.0F, last_column);
  int column = floor_to_int(x);
  const float right = x - static_cast<float>(column);
  if (column < 0 || column >= level.width) {
    column = (column % level.width + level.width) % level.width;
  }
  const auto row = static_cast<int>(y);
  const int stride = level.width + 1;
  const std::uint32_t* upper =
      level.texels.data() + static_cast<std::ptrdiff_t>(row) * stride + column;
  const std::uint32_t* lower = row + 1 < level.height ? upper + stride : upper;
  // In between rows in 256ths, which 16 bits hold.
  const auto down = static_cast<std::uint16_t>((y - static_cast<float>(row)) * 256.0F + 0.5F);
  const auto up = static_cast<std::uint16_t>(256 - down);
  const UShort8 sides = unpack(upper) * up + unpack(lower) * down;
  const Float4 left = first_half(sides);
  return left + right * (second_half(sides) - left);
}

Texture::Filter Texture::filter(const Eigen::Vector2f& du, const Eigen::Vector2f& dv,
                                int most_taps) const {
  const auto width = static_cast<float>(levels_[0].width);
  const auto height = static_cast<float>(levels_[0].height);
  const auto length2 = [&](const Eigen::Vector2f& d) {
    return d.x() * width * (d.x() * width) + d.y() * height * (d.y() * height);
  };
  Filter filter;
  float longer2 = length2(du), shorter2 = length2(dv);
  filter.axis = du;
  if (shorter2 > longer2) {
    std::swap(shorter2, longer2);
    filter.axis = dv;
  }
  // Compared before the conversion: at grazing angles the ratio is beyond what an int holds.
  const auto most = static_cast<float>(most_taps);
  const float ratio = std::sqrt(std::min(longer2 / std::max(shorter2, 1.0F), most * most));
  // Taps may lie a little farther apart than the footprint is wide.
  constexpr float slack = 0.25F;
  filter.taps = std::max(-floor_to_int(slack - ratio), 1);
  const float each = 1.0F / static_cast<float>(filter.taps);
  const auto last_level = static_cast<float>(levels_.size() - 1);
  const float lod =
      std::clamp(0.5F * rough_log2(std::max(longer2 * each * each, 1.0F)), 0.0F, last_level);
  filter.level = static_cast<std::size_t>(lod);
  // Most of the way between two levels one of them alone will do; all of it where few taps will.
  const float alone = most_taps > 2 ? 0.35F : 0.49F;
  filter.coarser = std::clamp(
      (lod - static_cast<float>(filter.level) - alone) / (1.0F - 2.0F * alone), 0.0F, 1.0F);
  if (filter.coarser >= 1.0F) {
    ++filter.level;
    filter.coarser = 0.0F;
  }
  return filter;
}

cv::Vec3f Texture::sample(const Eigen::Vector2f& uv, const Filter& filter) const {
  const Level& level = levels_[filter.level];
  const float each = 1.0F / static_cast<float>(filter.taps);
  Float4 sum = {};
  for (int i = 0; i < filter.taps; ++i) {
    const float along = (static_cast<float>(i) + 0.5F) * each - 0.5F;
    const float u = uv.x() + along * filter.axis.x(), v = uv.y() + along * filter.axis.y();
    Float4 colour = bilinear(level, u, v);
    if (filter.coarser > 0.0F) {
      colour += filter.coarser * (bilinear(levels_[filter.level + 1], u, v) - colour);
    }
    sum += colour;
  }
  sum *= each / 256.0F;
  return {sum[0], sum[1], sum[2]};
}

LinearLight::LinearLight() {
  static const auto table = [] {
    std::array<float, 255 * parts + 1> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double c = static_cast<double>(i) / (255.0 * parts);
      values[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return values;
  }();
  table_ = table.data();
}

float linear_light(float level) { return LinearLight()(level); }

}  // namespace dkp_slam
