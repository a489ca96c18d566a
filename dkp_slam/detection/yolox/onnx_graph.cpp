#include "dkp_slam/detection/yolox/onnx_graph.h"

#include <algorithm>

namespace dkp_slam::onnx {

using protobuf::child;
using protobuf::children;

std::string_view image_input(std::string_view graph) {
  std::vector<std::string_view> weights;
  for (const std::string_view w : children(graph, graph_weight)) {
    weights.push_back(child(w, weight_name));
  }
  std::vector<std::string_view> inputs;
  for (const std::string_view input : children(graph, graph_input)) {
    const bool weight =
        std::find(weights.begin(), weights.end(), child(input, value_name)) != weights.end();
    if (!weight) inputs.push_back(input);
  }
  return inputs.size() == 1 ? inputs[0] : std::string_view();
}

std::vector<std::int64_t> shape_of(std::string_view value) {
  const std::string_view tensor = child(child(value, value_type), type_tensor);
  std::vector<std::int64_t> shape;
  for (std::string_view dimension : children(child(tensor, tensor_shape), shape_dimension)) {
    const auto field = protobuf::take_field(dimension);
    shape.push_back(
        field && field->number == dimension_value ? static_cast<std::int64_t>(field->value) : -1);
  }
  return shape;
}

std::string reshaped(std::string_view value, const std::vector<std::int64_t>& shape) {
  std::string dimensions;
  for (const std::int64_t d : shape) {
    dimensions += protobuf::written(
        shape_dimension, protobuf::written(dimension_value, static_cast<std::uint64_t>(d)));
  }
  return with(value, value_type, [&](std::string_view type) {
    return with(type, type_tensor, [&](std::string_view tensor) {
      return with(tensor, tensor_shape, [&](std::string_view) { return dimensions; });
    });
  });
}

}  // namespace dkp_slam::onnx
