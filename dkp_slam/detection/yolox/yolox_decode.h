#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/detection/class_table.h"
#include "dkp_slam/detection/detector.h"
#include "dkp_slam/detection/yolox_options.h"

namespace dkp_slam {

/// How YOLOX's official exports expect and give their numbers (YOLOX, Ge et al. 2021; its
/// demo/ONNXRuntime): input BGR 0..255 in planes, letterboxed at the top left; output not decoded.
namespace yolox {

/// Grey that fills the letterbox, the value YOLOX was trained with.
constexpr float padding = 114.0F;
/// Columns of an output row: box (4), objectness (1), one score per COCO class (80).
constexpr int row_length = 85;

/// How a network takes an image: in three planes (blue, green, red), or these cut into the four
/// phases of 2 x 2 pixels (`onnx_without_focus`): twelve planes of half the size.
enum class InputLayout { planes, phases };

/// Rows of the output for an input of `size`: cells of the grids of strides 8, 16 and 32.
int row_count(const cv::Size& size);

/// The smallest input, in multiples of 32, that shows all of an image of size `image` as large as
/// an input of size `whole` does.
cv::Size filled_part(const cv::Size& whole, const cv::Size& image);

/// Writes `image` (CV_8UC3, BGR) into `input` (3 * height * width floats in `layout`), resized by
/// one factor to fit `size` (both sides even), at the top left, the rest `padding`. Returns the
/// factor (input pixels per image pixel). `scratch` keeps its memory from call to call.
float letterbox(const cv::Mat& image, const cv::Size& size, InputLayout layout, float* input,
                cv::Mat& scratch);

/// Boxes of `output` (`row_count(size)` rows of `row_length` floats) in pixels of an image of
/// `image_size` that went in scaled by `factor`, clipped to it, strongest first. A row yields one
/// box per class of weight above 1 that reaches the lowest score; boxes of weight 1 are ignored
/// (algorithm.md, §3.2).
std::vector<Detection> decode(const float* output, const cv::Size& size, float factor,
                              const cv::Size& image_size, const ClassTable& classes,
                              const DecodeOptions& options);

/// Class-aware non-maximum suppression, strongest first; equal scores keep their order.
std::vector<Detection> suppress_overlaps(std::vector<Detection> boxes, float iou);

}  // namespace yolox
}  // namespace dkp_slam
