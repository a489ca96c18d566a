// Outputs of a network: decoded as a plain loop in double precision would, and suppressed as
// OpenCV's dnn does it.
#include <cmath>
#include <map>

#include <opencv2/dnn.hpp>

#include "dkp_slam/detection/yolox/yolox_decode.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

const cv::Size network_size(64, 32);
const cv::Size image_size(100, 48);
constexpr float factor = 0.64F;

/// Rows as bytes say: which row, which column, what value. The others are 0.
std::vector<float> output_of(Reader& input) {
  const auto rows = static_cast<std::size_t>(yolox::row_count(network_size));
  std::vector<float> output(rows * yolox::row_length);
  while (!input.empty()) {
    const std::size_t row = input.take<std::uint8_t>() % rows;
    const std::size_t column = input.take<std::uint8_t>() % yolox::row_length;
    // Small numbers in steps, or any bits at all.
    const bool any = input.below(4) == 0;
    output[row * yolox::row_length + column] =
        any ? input.take<float>() : static_cast<float>(input.take<std::int8_t>()) / 64.0F;
  }
  return output;
}

/// How many boxes there are for certain, and how many there may be with rounding.
struct Count {
  int least = 0, most = 0;
};

Count count_boxes(const std::vector<float>& output, const ClassTable& classes, double lowest) {
  constexpr double rounding = 1e-4;
  Count count;
  const float* row = output.data();
  for (const int stride : {8, 16, 32}) {
    const double step = stride / double{factor};
    for (int v = 0; v < network_size.height / stride; ++v) {
      for (int u = 0; u < network_size.width / stride; ++u, row += yolox::row_length) {
        const double width = std::exp(double{row[2]}) * step,
                     height = std::exp(double{row[3]}) * step;
        const double x = (double{row[0]} + u) * step, y = (double{row[1]} + v) * step;
        // What overlaps the image, by a margin that rounding cannot take away.
        const double right = std::min(x + width / 2, double(image_size.width)),
                     bottom = std::min(y + height / 2, double(image_size.height)),
                     inner_width = right - std::max(x - width / 2, 0.0),
                     inner_height = bottom - std::max(y - height / 2, 0.0);
        const double margin = rounding * (1.0 + std::abs(x) + std::abs(y) + width + height);
        const bool sure = inner_width > margin && inner_height > margin && margin < 100.0;
        // NaN in either of them is no box.
        const bool possible = inner_width > -margin && inner_height > -margin;
        for (int id = 0; id < ClassTable::class_count; ++id) {
          const double score = double{row[4]} * row[5 + id];
          if (classes.weight(id) <= 1.0F || !possible) continue;
          count.least +=
              sure && row[4] > lowest && score > lowest + rounding && score < 1.0 - rounding;
          count.most += row[4] >= lowest && score > lowest - rounding && score < 1.0 + rounding;
        }
      }
    }
  }
  return count;
}

void check_decoded(const std::vector<Detection>& found, const yolox::DecodeOptions& options) {
  const cv::Rect2f image(0.0F, 0.0F, static_cast<float>(image_size.width),
                         static_cast<float>(image_size.height));
  float last = 1.0F;
  for (const Detection& d : found) {
    require(d.score >= options.lowest_score && d.score <= last, "scores out of bounds or order");
    require(d.box.width > 0.0F && d.box.height > 0.0F && (d.box | image) == image,
            "a box outside the image");
    require(d.weight > 1.0F, "a box of a class to be ignored");
    last = d.score;
  }
}

/// Boxes of whole pixels up to 64 and a bound of 29/64 make both sides exact.
void compare_suppression(Reader& input) {
  constexpr float iou = 29.0F / 64.0F;
  std::vector<Detection> boxes;
  std::map<int, std::vector<cv::Rect2d>> of_class;
  std::map<int, std::vector<float>> scores;
  while (!input.empty() && boxes.size() < 60) {
    Detection d;
    d.class_id = input.below(3);
    d.box = cv::Rect2f(
        cv::Rect(input.below(64), input.below(64), 1 + input.below(64), 1 + input.below(64)));
    d.score = static_cast<float>(1 + input.take<std::uint8_t>()) / 256.0F;
    of_class[d.class_id].emplace_back(d.box);
    scores[d.class_id].push_back(d.score);
    boxes.push_back(d);
  }
  const std::vector<Detection> kept = yolox::suppress_overlaps(boxes, iou);
  std::size_t count = 0;
  for (const auto& [id, rectangles] : of_class) {
    std::vector<int> chosen;
    cv::dnn::NMSBoxes(rectangles, scores[id], 0.0F, iou, chosen);
    std::vector<cv::Rect2d> ours;
    for (const Detection& d : kept) {
      if (d.class_id == id) ours.emplace_back(d.box);
    }
    require(ours.size() == chosen.size(), "OpenCV keeps more or fewer boxes");
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      require(ours[i] == rectangles[static_cast<std::size_t>(chosen[i])],
              "OpenCV keeps other boxes");
    }
    count += chosen.size();
  }
  require(count == kept.size(), "a box of no class");
}

void run(Bytes bytes) {
  Reader input(bytes);
  if (input.below(2) == 1) return compare_suppression(input);
  static const ClassTable classes;
  yolox::DecodeOptions options;
  options.nms_iou = 1.0F;  // keeps all
  const std::vector<float> output = output_of(input);
  const std::vector<Detection> all =
      yolox::decode(output.data(), network_size, factor, image_size, classes, options);
  check_decoded(all, options);
  const Count count = count_boxes(output, classes, options.lowest_score);
  const auto found = static_cast<int>(all.size());
  require(found >= count.least && found <= count.most, "a plain loop finds more or fewer boxes");
  check_decoded(yolox::suppress_overlaps(all, 0.45F), options);
}

std::vector<std::string> seeds() {
  std::string one{'\0'};
  const auto set = [&one](int row, int column, int value) {
    for (const int byte : {row, column, 1, value}) one += static_cast<char>(byte);
  };
  for (const auto& [column, value] : {std::pair(0, 32), {1, 32}, {2, 16}, {4, 60}, {5, 50}}) {
    set(3, column, value);
    set(33, column, value);
  }
  std::string any{"\0\3\4\0\0\0\300\177", 8};
  std::string boxes{'\1'};
  for (int i = 0; i < 120; ++i) boxes += static_cast<char>(i * 29 % 97);
  return {one, one + any.substr(1), boxes};
}

const Registration registration({"yolox_decode", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
