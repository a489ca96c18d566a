#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace dkp_slam {

/// Shape of the input of an ONNX model, read from the bytes of its file (protobuf wire format,
/// onnx.proto3); -1 for a free dimension. Empty unless the bytes are an ONNX model with one input.
/// OpenCV 4.6 reads the shape too, but has no way to tell it.
std::vector<std::int64_t> onnx_input_shape(std::string_view file);

}  // namespace dkp_slam
