#pragma once

#include <string>
#include <string_view>

namespace dkp_slam {

/// The model without its first layer where that does nothing but deal an image out: YOLOX's
/// "Focus" puts every second pixel of every second row, four times, over each other as channels.
/// Whoever writes the input can do that at no cost; ONNX Runtime's slices take an eighth of its
/// time. The input of what is left is [1, 12, H / 2, W / 2]: the three channels of the upper left
/// pixels of 2 x 2, then of the lower left, upper right, lower right ones. Empty where `file`, the
/// bytes of an ONNX model, does not begin so.
std::string onnx_without_focus(std::string_view file);

}  // namespace dkp_slam
