#include "dkp_slam/detection/yolox/yolox_decode.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam::yolox {
namespace {

constexpr std::array<int, 3> strides{8, 16, 32};

std::string shape_text(const std::vector<std::int64_t>& shape) {
  std::string text = "[";
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (i > 0) text += ", ";
    text += shape[i] < 0 ? "?" : std::to_string(shape[i]);
  }
  return text + "]";
}

/// True for `wanted`, and for a dimension the model leaves free.
bool one_or_free(std::int64_t dimension) { return dimension == 1 || dimension < 0; }

}  // namespace

int row_count(const cv::Size& size) {
  int rows = 0;
  for (int stride : strides) rows += (size.width / stride) * (size.height / stride);
  return rows;
}

float letterbox(const cv::Mat& image, const cv::Size& size, float* planes, cv::Mat& scratch) {
  CV_Assert(image.type() == CV_8UC3 && !image.empty());
  const float factor = std::min(static_cast<float>(size.width) / image.cols,
                                static_cast<float>(size.height) / image.rows);
  const cv::Size inner(std::clamp(static_cast<int>(image.cols * factor), 1, size.width),
                       std::clamp(static_cast<int>(image.rows * factor), 1, size.height));
  const cv::Mat* resized = &image;
  if (inner != image.size()) {
    cv::resize(image, scratch, inner, 0, 0, cv::INTER_LINEAR);
    resized = &scratch;
  }
  const std::size_t area = static_cast<std::size_t>(size.area());
  for (int y = 0; y < size.height; ++y) {
    float* blue = planes + static_cast<std::size_t>(y) * size.width;
    float* green = blue + area;
    float* red = green + area;
    const int filled = y < inner.height ? inner.width : 0;
    if (filled > 0) {
      const uchar* in = resized->ptr<uchar>(y);
      for (int x = 0; x < filled; ++x) {
        blue[x] = in[3 * x];
        green[x] = in[3 * x + 1];
        red[x] = in[3 * x + 2];
      }
    }
    for (float* plane : {blue, green, red}) std::fill(plane + filled, plane + size.width, padding);
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

cv::Size check_shapes(const std::string& model, const std::vector<std::int64_t>& input,
                      const std::vector<std::int64_t>& output) {
  const bool image_input = input.size() == 4 && one_or_free(input[0]) && input[1] == 3 &&
                           input[2] > 0 && input[3] > 0 && input[2] % 32 == 0 &&
                           input[3] % 32 == 0 && input[2] <= 4096 && input[3] <= 4096;
  if (!image_input) {
    throw Error("'" + model + "' is not a YOLOX model: its input is " + shape_text(input) +
                ", not [1, 3, H, W] with fixed H and W, multiples of 32 (its output is " +
                shape_text(output) + "); use an official YOLOX export (scripts/fetch_model.sh)");
  }
  const cv::Size size(static_cast<int>(input[3]), static_cast<int>(input[2]));
  const std::vector<std::int64_t> wanted{1, row_count(size), row_length};
  const bool yolox_output = output.size() == 3 && one_or_free(output[0]) &&
                            output[1] == wanted[1] && output[2] == wanted[2];
  if (!yolox_output) {
    throw Error("'" + model + "' is not a YOLOX model of the COCO classes: its output is " +
                shape_text(output) + ", not " + shape_text(wanted) +
                "; use an official YOLOX export (scripts/fetch_model.sh)");
  }
  return size;
}

}  // namespace dkp_slam::yolox
