#include "dkp_slam/detection/yolox/yolox_model.h"

#include <fstream>
#include <iterator>

#include "dkp_slam/detection/yolox/onnx_shapes.h"
#include "dkp_slam/detection/yolox/yolox_decode.h"
#include "dkp_slam/error.h"

namespace dkp_slam::yolox {
namespace {

std::string shape_text(const std::vector<std::int64_t>& shape) {
  std::string text = "[";
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (i > 0) text += ", ";
    text += shape[i] < 0 ? "?" : std::to_string(shape[i]);
  }
  return text + "]";
}

bool usable_side(std::int64_t side) { return side > 0 && side % 32 == 0 && side <= 4096; }

/// True for `wanted`, and for a dimension the model leaves free.
bool one_or_free(std::int64_t dimension) { return dimension == 1 || dimension < 0; }

}  // namespace

std::string read_model(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (!in.good() && !in.eof()) throw Error("cannot read the model '" + file.string() + "'");
  return bytes;
}

std::string cut_to_images(const std::string& model, const cv::Size& images) {
  std::vector<std::int64_t> shape = onnx_input_shape(model);
  if (images.empty() || shape.size() != 4 || !usable_side(shape[2]) || !usable_side(shape[3])) {
    return {};
  }
  const cv::Size whole(static_cast<int>(shape[3]), static_cast<int>(shape[2]));
  const cv::Size part = filled_part(whole, images);
  if (part == whole) return {};
  return onnx_with_shapes(model, {1, 3, part.height, part.width}, {1, row_count(part), row_length});
}

cv::Size check_shapes(const std::string& model, const std::vector<std::int64_t>& input,
                      const std::vector<std::int64_t>& output) {
  const bool image_input = input.size() == 4 && one_or_free(input[0]) && input[1] == 3 &&
                           usable_side(input[2]) && usable_side(input[3]);
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
