#include "dkp_slam/detection/yolox/onnx_shapes.h"

#include "dkp_slam/detection/yolox/onnx_graph.h"
#include "dkp_slam/detection/yolox/protobuf.h"

namespace dkp_slam {

using protobuf::child;

std::vector<std::int64_t> onnx_input_shape(std::string_view file) {
  const std::vector<std::string_view> inputs = onnx::image_inputs(child(file, onnx::model_graph));
  if (inputs.size() != 1) return {};
  return onnx::shape_of(inputs[0]);
}

std::string onnx_with_shapes(std::string_view file, const std::vector<std::int64_t>& input,
                             const std::vector<std::int64_t>& output) {
  const std::string_view graph = child(file, onnx::model_graph);
  const std::vector<std::string_view> inputs = onnx::image_inputs(graph);
  if (inputs.size() != 1) return {};
  std::string changed;
  for (std::string_view rest = graph; !rest.empty();) {
    const auto field = protobuf::take_field(rest);
    if (!field) return {};
    if (field->number == onnx::graph_value) continue;
    if (field->number == onnx::graph_input && field->bytes == inputs[0]) {
      changed += protobuf::written(onnx::graph_input, onnx::reshaped(field->bytes, input));
    } else if (field->number == onnx::graph_output) {
      changed += protobuf::written(onnx::graph_output, onnx::reshaped(field->bytes, output));
    } else {
      changed += protobuf::written(*field);
    }
  }
  return onnx::with(file, onnx::model_graph, [&](std::string_view) { return changed; });
}

}  // namespace dkp_slam
