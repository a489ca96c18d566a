#include "dkp_slam/detection/yolox/onnx_focus.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <vector>

#include "dkp_slam/detection/yolox/onnx_graph.h"
#include "dkp_slam/detection/yolox/protobuf.h"

namespace dkp_slam {
namespace {

using protobuf::child;
using protobuf::children;

/// Which of two rows and of two columns a part of the image has; -1 where it has both.
using Phase = std::array<int, 2>;
constexpr Phase whole_image{-1, -1};
/// In the order in which Focus puts them over each other.
constexpr std::array<Phase, 4> focus_order{Phase{0, 0}, Phase{1, 0}, Phase{0, 1}, Phase{1, 1}};

std::optional<std::uint64_t> varint_field(std::string_view message, std::uint64_t number) {
  while (!message.empty()) {
    const auto field = protobuf::take_field(message);
    if (!field) break;
    if (field->number == number && field->type == protobuf::WireType::varint) return field->value;
  }
  return std::nullopt;
}

/// The value of a weight that is one integer (TensorProto of int64).
std::optional<std::int64_t> integer(std::string_view weight) {
  constexpr std::uint64_t int64_type = 7;
  if (varint_field(weight, onnx::weight_type) != int64_type) return std::nullopt;
  if (const std::string_view raw = child(weight, onnx::weight_bytes); !raw.empty()) {
    std::int64_t value = 0;
    if (raw.size() != sizeof value) return std::nullopt;
    std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }
  std::vector<std::uint64_t> listed;
  while (!weight.empty()) {
    const auto field = protobuf::take_field(weight);
    if (!field) return std::nullopt;
    if (field->number != onnx::weight_integers) continue;
    if (field->type == protobuf::WireType::varint) listed.push_back(field->value);
    for (std::string_view packed = field->bytes; !packed.empty();) {
      const auto value = protobuf::take_varint(packed);
      if (!value) return std::nullopt;
      listed.push_back(*value);
    }
  }
  if (listed.size() != 1) return std::nullopt;
  return static_cast<std::int64_t>(listed[0]);
}

/// Looks through a graph for the layers that deal its image out.
class Focus {
 public:
  /// `size`: rows and columns of the image.
  Focus(std::string_view graph, std::string_view image, const std::array<std::int64_t, 2>& size)
      : size_(size) {
    parts_[image] = whole_image;
    for (const std::string_view w : children(graph, onnx::graph_weight)) {
      if (const auto value = integer(w)) integers_[child(w, onnx::weight_name)] = *value;
    }
    // A graph's nodes stand in the order in which they can be computed.
    for (const std::string_view node : children(graph, onnx::graph_node)) {
      if (!take(node)) return;
    }
    const std::vector<std::string_view> outputs = children(graph, onnx::graph_output);
    found_ = !joined_.empty() && std::none_of(outputs.begin(), outputs.end(), [&](auto output) {
      return parts_.count(child(output, onnx::value_name)) != 0;
    });
  }

  /// Whether all that is done with the image itself is to deal it out.
  bool found() const { return found_; }
  /// Whether a node is part of that.
  bool has(std::string_view node) const {
    return std::find(nodes_.begin(), nodes_.end(), node) != nodes_.end();
  }
  /// What the parts are called once they lie over each other.
  std::string_view joined() const { return joined_; }

 private:
  /// False where it does something else with the image or with parts of it.
  bool take(std::string_view node) {
    const std::vector<std::string_view> inputs = children(node, onnx::node_input);
    const bool uses_parts = std::any_of(inputs.begin(), inputs.end(), [&](std::string_view name) {
      return parts_.count(name) != 0;
    });
    if (!uses_parts) return true;
    const std::vector<std::string_view> outputs = children(node, onnx::node_output);
    if (outputs.size() != 1) return false;
    const std::string_view operation = child(node, onnx::node_operation);
    if (operation == "Slice") {
      const auto part = slice(inputs);
      if (!part) return false;
      parts_[outputs[0]] = *part;
    } else if (operation == "Concat" && joined_.empty() && joins_channels(node, inputs)) {
      joined_ = outputs[0];
    } else {
      return false;
    }
    nodes_.push_back(node);
    return true;
  }

  /// What a Slice of data, starts, ends, axes and steps leaves of a part: every second row or
  /// column of it.
  std::optional<Phase> slice(const std::vector<std::string_view>& inputs) const {
    constexpr std::int64_t rows = 2, columns = 3;
    const auto of = parts_.find(inputs[0]);
    if (inputs.size() != 5 || of == parts_.end()) return std::nullopt;
    std::array<std::int64_t, 4> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto value = integers_.find(inputs[i + 1]);
      if (value == integers_.end()) return std::nullopt;
      values[i] = value->second;
    }
    const auto [start, end, axis, step] = values;
    if (start < 0 || start > 1 || step != 2 || axis < rows || axis > columns) return std::nullopt;
    const auto side = static_cast<std::size_t>(axis - rows);
    Phase part = of->second;
    int& cut = part[side];
    if (cut >= 0 || end < size_[side]) return std::nullopt;
    cut = static_cast<int>(start);
    return part;
  }

  bool joins_channels(std::string_view node, const std::vector<std::string_view>& inputs) const {
    const std::vector<std::string_view> attributes = children(node, onnx::node_attribute);
    if (attributes.size() != 1 || child(attributes[0], onnx::attribute_name) != "axis" ||
        varint_field(attributes[0], onnx::attribute_integer) != 1) {
      return false;
    }
    return std::equal(inputs.begin(), inputs.end(), focus_order.begin(), focus_order.end(),
                      [&](std::string_view name, const Phase& wanted) {
                        const auto part = parts_.find(name);
                        return part != parts_.end() && part->second == wanted;
                      });
  }

  std::array<std::int64_t, 2> size_;
  std::map<std::string_view, std::int64_t> integers_;
  std::map<std::string_view, Phase> parts_;
  std::vector<std::string_view> nodes_;
  std::string_view joined_;
  bool found_ = false;
};

}  // namespace

std::string onnx_without_focus(std::string_view file) {
  const std::string_view graph = child(file, onnx::model_graph);
  const std::string_view image = onnx::image_input(graph);
  const std::vector<std::int64_t> shape = onnx::shape_of(image);
  if (shape.size() != 4 || shape[1] != 3 || shape[2] <= 0 || shape[3] <= 0 || shape[2] % 2 != 0 ||
      shape[3] % 2 != 0) {
    return {};
  }
  const Focus focus(graph, child(image, onnx::value_name), {shape[2], shape[3]});
  if (!focus.found()) return {};
  return onnx::with_graph(file, [&](const protobuf::Field& field) {
    if (field.number == onnx::graph_node && focus.has(field.bytes)) return std::string();
    if (field.number != onnx::graph_input || field.bytes != image) return protobuf::written(field);
    const std::string dealt = onnx::reshaped(image, {1, 12, shape[2] / 2, shape[3] / 2});
    return protobuf::written(
        field.number,
        onnx::with(dealt, onnx::value_name, [&](std::string_view) { return focus.joined(); }));
  });
}

}  // namespace dkp_slam
