#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

/// Files of YOLOX's official ONNX exports.
namespace dkp_slam::yolox {

/// Bytes of a model's file; throws `Error` when it can't be read.
std::string read_model(const std::filesystem::path& file);

/// `model`, the bytes of an ONNX file, cut to take `filled_part` of its input for images of size
/// `images`. Empty where nothing is to be cut: `images` are 0 x 0 or fill the input.
std::string cut_to_images(const std::string& model, const cv::Size& images);

/// Input size of a network with input shape `input` and output shape `output`; -1 stands for a
/// free batch dimension. Throws `Error`, which names the shapes, unless they are
/// [1, 3, H, W] with H and W fixed multiples of 32 and [1, row_count, row_length].
cv::Size check_shapes(const std::string& model, const std::vector<std::int64_t>& input,
                      const std::vector<std::int64_t>& output);

}  // namespace dkp_slam::yolox
