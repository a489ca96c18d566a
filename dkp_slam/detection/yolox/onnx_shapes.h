#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dkp_slam {

/// Shape of the input of an ONNX model, read from the bytes of its file (protobuf wire format,
/// onnx.proto3); -1 for a free dimension. Empty unless the bytes are an ONNX model with one input.
/// OpenCV 4.6 reads the shape too, but has no way to tell it.
std::vector<std::int64_t> onnx_input_shape(std::string_view file);

/// The model with another size of image: its one input and all its outputs get the shapes given,
/// and what the file says of the shapes in between is left out, for the library to infer. A network
/// of convolutions runs so; one with sizes among its weights does not load. Empty unless the bytes
/// are an ONNX model with one input.
std::string onnx_with_shapes(std::string_view file, const std::vector<std::int64_t>& input,
                             const std::vector<std::int64_t>& output);

}  // namespace dkp_slam
