#include "dkp_slam/detection/yolox/onnx_shapes.h"

#include "dkp_slam/detection/yolox/onnx_graph.h"
#include "dkp_slam/detection/yolox/protobuf.h"

namespace dkp_slam {

std::vector<std::int64_t> onnx_input_shape(std::string_view file) {
  return onnx::shape_of(onnx::image_input(protobuf::child(file, onnx::model_graph)));
}

std::string onnx_with_shapes(std::string_view file, const std::vector<std::int64_t>& input,
                             const std::vector<std::int64_t>& output) {
  const std::string_view image = onnx::image_input(protobuf::child(file, onnx::model_graph));
  if (image.empty()) return {};
  return onnx::with_graph(file, [&](const protobuf::Field& field) {
    if (field.number == onnx::graph_input && field.bytes == image) {
      return protobuf::written(field.number, onnx::reshaped(image, input));
    }
    if (field.number == onnx::graph_output) {
      return protobuf::written(field.number, onnx::reshaped(field.bytes, output));
    }
    return protobuf::written(field);
  });
}

}  // namespace dkp_slam
