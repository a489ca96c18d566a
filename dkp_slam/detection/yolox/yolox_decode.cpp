#include "dkp_slam/detection/yolox/yolox_decode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <opencv2/imgproc.hpp>

namespace dkp_slam::yolox {
namespace {

constexpr std::array<int, 3> strides{8, 16, 32};

/// How an image of size `image` lies in an input of `size`.
struct Letterbox {
  Letterbox(const cv::Size& size, const cv::Size& image)
      : factor(std::min(static_cast<float>(size.width) / image.width,
                        static_cast<float>(size.height) / image.height)),
        inner(std::clamp(static_cast<int>(image.width * factor), 1, size.width),
              std::clamp(static_cast<int>(image.height * factor), 1, size.height)) {}
  float factor;    ///< pixels of the input per pixel of the image
  cv::Size inner;  ///< what the image fills, at the top left
};

/// One row of all three planes, which lie `area` apart: `filled` pixels, each `step` after the one
/// before it in `in`, then padding.
template <int step>
void write_row(const uchar* in, int filled, int width, float* blue, std::size_t area) {
  float* green = blue + area;
  float* red = green + area;
  for (int x = 0; x < filled; ++x) {
    const uchar* pixel = in + static_cast<std::ptrdiff_t>(3 * step) * x;
    blue[x] = pixel[0];
    green[x] = pixel[1];
    red[x] = pixel[2];
  }
  for (float* plane : {blue, green, red}) std::fill(plane + filled, plane + width, padding);
}

}  // namespace

int row_count(const cv::Size& size) {
  int rows = 0;
  for (int stride : strides) rows += (size.width / stride) * (size.height / stride);
  return rows;
}

cv::Size filled_part(const cv::Size& whole, const cv::Size& image) {
  const Letterbox box(whole, image);
  const auto filled = [](int used, int all) {
    return std::min(all, (used + strides.back() - 1) / strides.back() * strides.back());
  };
  return {filled(box.inner.width, whole.width), filled(box.inner.height, whole.height)};
}

float letterbox(const cv::Mat& image, const cv::Size& size, InputLayout layout, float* input,
                cv::Mat& scratch) {
  CV_Assert(image.type() == CV_8UC3 && !image.empty());
  CV_Assert(size.width % 2 == 0 && size.height % 2 == 0);
  const auto [factor, inner] = Letterbox(size, image.size());
  const cv::Mat* resized = &image;
  if (inner != image.size()) {
    cv::resize(image, scratch, inner, 0, 0, cv::INTER_LINEAR);
    resized = &scratch;
  }
  for (int y = 0; y < size.height; ++y) {
    const int filled = y < inner.height ? inner.width : 0;
    const uchar* in = filled > 0 ? resized->ptr<uchar>(y) : nullptr;
    if (layout == InputLayout::planes) {
      const auto area = static_cast<std::size_t>(size.area());
      write_row<1>(in, filled, size.width, input + static_cast<std::size_t>(y) * size.width, area);
      continue;
    }
    const int width = size.width / 2;
    const std::size_t area = static_cast<std::size_t>(size.area()) / 4;
    float* even = input + static_cast<std::size_t>(y / 2) * width + (y % 2 == 0 ? 0 : 3 * area);
    write_row<2>(in, (filled + 1) / 2, width, even, area);
    write_row<2>(filled > 0 ? in + 3 : in, filled / 2, width, even + 6 * area, area);
  }
  return factor;
}

std::vector<Detection> decode(const float* output, const cv::Size& size, float factor,
                              const cv::Size& image_size, const ClassTable& classes,
                              const DecodeOptions& options) {
  std::vector<int> movable;
  for (int id = 0; id < ClassTable::class_count; ++id) {
    if (classes.weight(id) > 1.0F) movable.push_back(id);
  }
  const cv::Rect2f image(0.0F, 0.0F, static_cast<float>(image_size.width),
                         static_cast<float>(image_size.height));
  std::vector<Detection> found;
  const float* row = output;
  for (int stride : strides) {
    const float step = static_cast<float>(stride) / factor;
    for (int v = 0; v < size.height / stride; ++v) {
      for (int u = 0; u < size.width / stride; ++u, row += row_length) {
        const float objectness = row[4];
        if (!(objectness >= options.lowest_score)) continue;  // a class score is at most 1
        const float width = std::exp(row[2]) * step, height = std::exp(row[3]) * step;
        const cv::Rect2f box((row[0] + u) * step - 0.5F * width,
                             (row[1] + v) * step - 0.5F * height, width, height);
        const cv::Rect2f clipped = box & image;
        if (!std::isfinite(box.x + box.y + width + height) || clipped.empty()) continue;
        for (int id : movable) {
          const float score = objectness * row[5 + id];
          // A network that says NaN or more than certainty of a row says nothing of it.
          if (!(score >= options.lowest_score && score <= 1.0F)) continue;
          Detection detection;
          detection.box = clipped;
          detection.class_id = id;
          detection.score = score;
          detection.weight = classes.weight(id);
          found.push_back(std::move(detection));
        }
      }
    }
  }
  return suppress_overlaps(std::move(found), options.nms_iou);
}

std::vector<Detection> suppress_overlaps(std::vector<Detection> boxes, float iou) {
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  std::vector<Detection> kept;
  for (Detection& box : boxes) {
    const bool covered = std::any_of(kept.begin(), kept.end(), [&](const Detection& stronger) {
      if (stronger.class_id != box.class_id) return false;
      const float common = (stronger.box & box.box).area();
      return common > iou * (stronger.box.area() + box.box.area() - common);
    });
    if (!covered) kept.push_back(std::move(box));
  }
  return kept;
}

}  // namespace dkp_slam::yolox
