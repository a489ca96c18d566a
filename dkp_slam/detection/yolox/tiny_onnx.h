#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

/// Writes small ONNX files for tests, byte by byte (protobuf wire format, onnx.proto3).
namespace dkp_slam::tiny_onnx {

inline std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
  return bytes + static_cast<char>(value);
}
inline std::string number(int field, std::uint64_t value) {
  // Not by operator+, at which g++ 12 warns without cause (bug 105651).
  return varint(static_cast<std::uint64_t>(field) << 3).append(varint(value));
}
inline std::string bytes(int field, const std::string& value) {
  return varint(static_cast<std::uint64_t>(field) << 3 | 2) + varint(value.size()) + value;
}

/// ValueInfoProto of a float tensor.
inline std::string value_info(const std::string& name, const std::vector<std::uint64_t>& shape) {
  std::string dimensions;
  for (std::uint64_t d : shape) dimensions += bytes(1, number(1, d));
  return bytes(1, name) + bytes(2, bytes(1, number(1, 1) + bytes(2, dimensions)));
}
/// TensorProto of int64 values in one dimension.
inline std::string int64_tensor(const std::string& name, const std::vector<std::uint64_t>& values) {
  std::string data;
  for (std::uint64_t v : values) data += number(7, v);
  return number(1, values.size()) + number(2, 7) + data + bytes(8, name);
}
inline std::string node(const std::string& operation, const std::vector<std::string>& inputs,
                        const std::string& output, const std::string& attributes = {}) {
  std::string text;
  for (const std::string& input : inputs) text += bytes(1, input);
  return bytes(1, text + bytes(2, output) + bytes(3, output) + bytes(4, operation) + attributes);
}

/// TensorProto of one int64 value as PyTorch writes it, in bytes.
inline std::string raw_int64(const std::string& name, std::uint64_t value) {
  std::string data;
  for (int i = 0; i < 8; ++i) data += static_cast<char>(value >> (8 * i) & 0xFF);
  return number(1, 1) + number(2, 7) + bytes(8, name) + bytes(9, data);
}
inline std::string axis(std::uint64_t value) {
  return bytes(5, bytes(1, "axis") + number(3, value) + number(20, 2));
}

/// YOLOX's first layer, with the weights it needs: "image" dealt out by twos to "dealt".
inline std::string focus() {
  const auto slice = [](const std::string& from, const std::string& start, const std::string& side,
                        const std::string& to) {
    return node("Slice", {from, start, "end", side, "two"}, to);
  };
  return slice("image", "zero", "two", "upper") + slice("image", "one", "two", "lower") +
         slice("upper", "zero", "three", "upper_left") +
         slice("lower", "zero", "three", "lower_left") +
         slice("upper", "one", "three", "upper_right") +
         slice("lower", "one", "three", "lower_right") +
         node("Concat", {"upper_left", "lower_left", "upper_right", "lower_right"}, "dealt",
              axis(1)) +
         bytes(5, raw_int64("zero", 0)) + bytes(5, raw_int64("one", 1)) +
         bytes(5, raw_int64("two", 2)) + bytes(5, int64_tensor("three", {3})) +
         bytes(5, raw_int64("end", INT64_MAX));
}

/// The start of a file of that graph: IR version 4, operator set 11.
inline std::string model(const std::string& graph) {
  return number(1, 4) + bytes(7, graph) + bytes(8, number(2, 11));
}

/// Writes a model whose output, of shape [1, rows, columns], is the start of `from` (of 3 x `side`
/// x `side` numbers), in memory's order: the image (1 x 3 x `side` x `side`), or what `graph`
/// makes.
inline void write_rows(const std::filesystem::path& file, const std::string& graph,
                       const std::string& from, std::uint64_t side, std::uint64_t rows,
                       std::uint64_t columns) {
  std::ofstream(file, std::ios::binary)
      << model(graph + node("Reshape", {from, "flat_shape"}, "flat") +
               node("Slice", {"flat", "first", "last", "across"}, "part") +
               node("Reshape", {"part", "row_shape"}, "rows") + bytes(2, "tiny") +
               bytes(5, raw_int64("first", 0)) + bytes(5, raw_int64("last", rows * columns)) +
               bytes(5, raw_int64("across", 1)) +
               bytes(5, int64_tensor("flat_shape", {1, 3 * side * side})) +
               bytes(5, int64_tensor("row_shape", {1, rows, columns})) +
               bytes(11, value_info("image", {1, 3, side, side})) +
               bytes(12, value_info("rows", {1, rows, columns})));
}

/// Its output is the start of its input. With 85 columns and YOLOX's number of rows it passes for a
/// YOLOX whose detections are written in the image...
inline void write_model(const std::filesystem::path& file, std::uint64_t side, std::uint64_t rows,
                        std::uint64_t columns) {
  write_rows(file, {}, "image", side, rows, columns);
}

/// ... and this for one that deals its image out first.
inline void write_focus_model(const std::filesystem::path& file, std::uint64_t side,
                              std::uint64_t rows, std::uint64_t columns) {
  write_rows(file, focus(), "dealt", side, rows, columns);
}

}  // namespace dkp_slam::tiny_onnx
