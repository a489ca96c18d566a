// Files of networks, as far as they are read here.
#include "dkp_slam/detection/yolox/onnx_focus.h"
#include "dkp_slam/detection/yolox/onnx_shapes.h"
#include "dkp_slam/detection/yolox/tiny_onnx.h"
#include "dkp_slam/detection/yolox/yolox_decode.h"
#include "dkp_slam/detection/yolox/yolox_model.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

void run(Bytes bytes) {
  if (const std::string left = onnx_without_focus(text_of(bytes)); !left.empty()) {
    const std::vector<std::int64_t> dealt = onnx_input_shape(left);
    require(dealt.size() == 4 && dealt[1] == 12, "an image that is not dealt out");
    require(onnx_without_focus(left).empty(), "an image that is dealt out twice");
  }
  const std::vector<std::int64_t> shape = onnx_input_shape(text_of(bytes));
  std::vector<std::int64_t> output{1, 21, yolox::row_length};
  takes([&] {
    const cv::Size size = yolox::check_shapes("model.onnx", shape, output);
    require(yolox::row_count(size) == output[1], "a size that does not belong to the output");
  });
  const std::string cut = yolox::cut_to_images(std::string(text_of(bytes)), {64, 32});
  if (cut.empty()) return;
  const std::vector<std::int64_t> part = onnx_input_shape(cut);
  require(part.size() == 4 && part[2] <= shape[2] && part[3] <= shape[3], "a cut that is no cut");
}

std::vector<std::string> seeds() {
  using namespace tiny_onnx;
  const std::string graph = node("Identity", {"in"}, "out") + bytes(2, "g") +
                            bytes(11, value_info("in", {1, 3, 32, 32})) +
                            bytes(12, value_info("out", {1, 21, 85}));
  const std::string dealing = focus() + node("Identity", {"dealt"}, "out") +
                              bytes(11, value_info("image", {1, 3, 32, 32})) +
                              bytes(12, value_info("out", {1, 12, 16, 16}));
  return {number(1, 4) + bytes(7, graph) + bytes(8, number(2, 9)), model(dealing)};
}

const Registration registration({"onnx_shape", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
