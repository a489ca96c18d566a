#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dkp_slam/detection/yolox/protobuf.h"

/// Parts of ONNX models in protobuf's wire format: what reads and rewrites them shares.
namespace dkp_slam::onnx {

// Numbers of fields in onnx.proto3.
constexpr std::uint64_t model_graph = 7;
constexpr std::uint64_t graph_node = 1, graph_weight = 5;
constexpr std::uint64_t graph_input = 11, graph_output = 12, graph_value = 13;
constexpr std::uint64_t node_input = 1, node_output = 2, node_operation = 4, node_attribute = 5;
constexpr std::uint64_t attribute_name = 1, attribute_integer = 3;
constexpr std::uint64_t weight_dimension = 1, weight_type = 2, weight_integers = 7;
constexpr std::uint64_t weight_name = 8, weight_bytes = 9;
constexpr std::uint64_t value_name = 1, value_type = 2;
constexpr std::uint64_t type_tensor = 1, tensor_shape = 2, shape_dimension = 1;
constexpr std::uint64_t dimension_value = 1;

/// The value that goes into the network as an image; empty unless there is exactly one. Old exports
/// list the weights among the inputs.
std::string_view image_input(std::string_view graph);

/// Dimensions of a value of the graph (ValueInfoProto); -1 for a free one.
std::vector<std::int64_t> shape_of(std::string_view value);

/// A value of the graph with another shape.
std::string reshaped(std::string_view value, const std::vector<std::int64_t>& shape);

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

/// The model with the fields of its graph as `change` writes them, and without what the file says
/// of the shapes in between, which the library infers. Empty where the graph is none.
template <class Change>
std::string with_graph(std::string_view file, Change change) {
  std::string graph;
  for (std::string_view rest = protobuf::child(file, model_graph); !rest.empty();) {
    const auto field = protobuf::take_field(rest);
    if (!field) return {};
    if (field->number != graph_value) graph += change(*field);
  }
  return with(file, model_graph, [&](std::string_view) { return graph; });
}

}  // namespace dkp_slam::onnx
