#include "dkp_slam/detection/yolox/onnx_shapes.h"

#include <algorithm>

#include "dkp_slam/detection/yolox/protobuf.h"

namespace dkp_slam {
namespace {

using protobuf::child;
using protobuf::children;

// Numbers of fields in onnx.proto3.
constexpr std::uint64_t model_graph = 7;
constexpr std::uint64_t graph_weight = 5, graph_input = 11, graph_output = 12, graph_value = 13;
constexpr std::uint64_t weight_name = 8;
constexpr std::uint64_t value_name = 1, value_type = 2;
constexpr std::uint64_t type_tensor = 1, tensor_shape = 2, shape_dimension = 1;
constexpr std::uint64_t dimension_value = 1;

/// What goes into the network as an image. Old exports list the weights among the inputs.
std::vector<std::string_view> image_inputs(std::string_view graph) {
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
  return inputs;
}

/// A message with the field of one number, where it has it, written anew by `change`.
template <class Change>
std::string with(std::string_view message, std::uint64_t number, Change change) {
  std::string out;
  while (!message.empty()) {
    const auto field = protobuf::take_field(message);
    if (!field) break;
    out += field->number == number ? protobuf::written(number, change(field->bytes))
                                   : protobuf::written(*field);
  }
  return out;
}

/// A value of the graph with another shape.
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

}  // namespace

std::vector<std::int64_t> onnx_input_shape(std::string_view file) {
  const std::vector<std::string_view> inputs = image_inputs(child(file, model_graph));
  if (inputs.size() != 1) return {};
  const std::string_view tensor = child(child(inputs[0], value_type), type_tensor);
  std::vector<std::int64_t> shape;
  for (std::string_view dimension : children(child(tensor, tensor_shape), shape_dimension)) {
    const auto field = protobuf::take_field(dimension);
    shape.push_back(
        field && field->number == dimension_value ? static_cast<std::int64_t>(field->value) : -1);
  }
  return shape;
}

std::string onnx_with_shapes(std::string_view file, const std::vector<std::int64_t>& input,
                             const std::vector<std::int64_t>& output) {
  const std::string_view graph = child(file, model_graph);
  const std::vector<std::string_view> inputs = image_inputs(graph);
  if (inputs.size() != 1) return {};
  std::string changed;
  for (std::string_view rest = graph; !rest.empty();) {
    const auto field = protobuf::take_field(rest);
    if (!field) return {};
    if (field->number == graph_value) continue;
    if (field->number == graph_input && field->bytes == inputs[0]) {
      changed += protobuf::written(graph_input, reshaped(field->bytes, input));
    } else if (field->number == graph_output) {
      changed += protobuf::written(graph_output, reshaped(field->bytes, output));
    } else {
      changed += protobuf::written(*field);
    }
  }
  return with(file, model_graph, [&](std::string_view) { return changed; });
}

}  // namespace dkp_slam
