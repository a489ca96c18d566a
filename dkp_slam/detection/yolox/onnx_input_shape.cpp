#include "dkp_slam/detection/yolox/onnx_input_shape.h"

#include <algorithm>
#include <optional>

namespace dkp_slam {
namespace {

/// One field of a protobuf message.
struct Field {
  std::uint64_t number = 0;
  std::uint64_t value = 0;  ///< of a varint
  std::string_view bytes;   ///< of a length-delimited field
};

std::optional<std::uint64_t> take_varint(std::string_view& in) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64 && !in.empty(); shift += 7) {
    const auto byte = static_cast<unsigned char>(in.front());
    in.remove_prefix(1);
    value |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
    if (byte < 0x80) return value;
  }
  return std::nullopt;
}

std::optional<Field> take_field(std::string_view& in) {
  enum WireType { varint = 0, fixed64 = 1, delimited = 2, fixed32 = 5 };
  const auto tag = take_varint(in);
  if (!tag) return std::nullopt;
  Field field;
  field.number = *tag >> 3;
  std::uint64_t length = 0;
  switch (*tag & 7) {
    case varint: {
      const auto value = take_varint(in);
      if (!value) return std::nullopt;
      field.value = *value;
      return field;
    }
    case fixed64:
      length = 8;
      break;
    case fixed32:
      length = 4;
      break;
    case delimited: {
      const auto value = take_varint(in);
      if (!value) return std::nullopt;
      length = *value;
      break;
    }
    default:
      return std::nullopt;
  }
  if (length > in.size()) return std::nullopt;
  field.bytes = in.substr(0, length);
  in.remove_prefix(length);
  return field;
}

/// Every length-delimited value of one field number.
std::vector<std::string_view> children(std::string_view message, std::uint64_t number) {
  std::vector<std::string_view> found;
  while (!message.empty()) {
    const auto field = take_field(message);
    if (!field) break;
    if (field->number == number) found.push_back(field->bytes);
  }
  return found;
}

std::string_view child(std::string_view message, std::uint64_t number) {
  const auto found = children(message, number);
  return found.empty() ? std::string_view() : found.front();
}

}  // namespace

std::vector<std::int64_t> onnx_input_shape(std::string_view file) {
  const std::string_view graph = child(file, 7);
  // Old exports list the weights among the inputs.
  std::vector<std::string_view> weights;
  for (std::string_view tensor : children(graph, 5)) weights.push_back(child(tensor, 8));
  std::vector<std::string_view> inputs;
  for (std::string_view input : children(graph, 11)) {
    if (std::find(weights.begin(), weights.end(), child(input, 1)) == weights.end()) {
      inputs.push_back(input);
    }
  }
  if (inputs.size() != 1) return {};
  const std::string_view tensor_type = child(child(inputs[0], 2), 1);
  std::vector<std::int64_t> shape;
  for (std::string_view dimension : children(child(tensor_type, 2), 1)) {
    const auto field = take_field(dimension);
    shape.push_back(field && field->number == 1 ? static_cast<std::int64_t>(field->value) : -1);
  }
  return shape;
}

}  // namespace dkp_slam
