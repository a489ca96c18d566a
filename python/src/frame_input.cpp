#include "python/src/frame_input.h"

#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/sensor/image_reader.h"

namespace dkp_slam::python {
namespace {

void check_size(const char* name, const cv::Mat& image, const Camera& camera) {
  if (image.cols == camera.width && image.rows == camera.height) return;
  value_error(fmt::format("{} is {} x {} pixels, the camera {} x {}; resize it or give its camera",
                          name, image.cols, image.rows, camera.width, camera.height));
}

void check_timestamp(double timestamp, const std::optional<double>& last) {
  if (!std::isfinite(timestamp)) {
    value_error(fmt::format("t is {}; give the image's time in seconds", timestamp));
  }
  if (last && timestamp <= *last) {
    value_error(
        fmt::format("t is {:.6f}, not after the last frame's {:.6f}; feed frames in the order "
                    "of their time stamps",
                    timestamp, *last));
  }
}

cv::Mat colour_of(const FrameInput& input, const Camera& camera) {
  if (input.order != "rgb" && input.order != "bgr") {
    value_error(fmt::format("order is '{}'; it must be rgb or bgr", input.order));
  }
  const cv::Mat image =
      borrow("rgb", array_named("rgb", input.rgb), CV_8UC3, "uint8 of shape (height, width, 3)");
  check_size("rgb", image, camera);
  const py::gil_scoped_release release;
  if (input.order == "bgr") return input.copy ? image.clone() : image;
  cv::Mat bgr;
  cv::cvtColor(image, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

bool known_or_zero(float depth, float least, float most) {
  return depth == 0.0F || (depth >= least && depth <= most);
}

/// Depth that is NaN or outside what the camera can tell becomes 0, unknown; where there is none
/// the image stays as it is.
cv::Mat without_unknown(const cv::Mat& depth, const Camera& camera) {
  const auto least = static_cast<float>(camera.min_depth);
  const auto most = static_cast<float>(camera.max_depth);
  bool good = true;
  for (int y = 0; y < depth.rows; ++y) {
    const auto* row = depth.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) good &= known_or_zero(row[x], least, most);
  }
  if (good) return depth;
  cv::Mat out = depth.clone();
  for (int y = 0; y < out.rows; ++y) {
    auto* row = out.ptr<float>(y);
    for (int x = 0; x < out.cols; ++x) {
      if (!known_or_zero(row[x], least, most)) row[x] = 0.0F;
    }
  }
  return out;
}

cv::Mat depth_of(const FrameInput& input, const Camera& camera) {
  const py::array array = array_named("depth", input.depth);
  const bool units = array.dtype().kind() == 'u' && array.itemsize() == 2;
  const cv::Mat image =
      borrow("depth", array, units ? CV_16UC1 : CV_32FC1,
             "float32 of shape (height, width), metres (depth.astype(numpy.float32)), or uint16 in "
             "units of depth_scale");
  check_size("depth", image, camera);
  const double scale = input.depth_scale.value_or(camera.depth_scale);
  if (!(scale > 0.0) || !std::isfinite(scale)) {
    value_error(fmt::format("depth_scale is {}; it must be above 0, units per metre", scale));
  }
  const py::gil_scoped_release release;
  if (units) return depth_in_metres(image, scale, camera.min_depth, camera.max_depth);
  cv::Mat metres = without_unknown(image, camera);
  return input.copy && metres.data == image.data ? metres.clone() : metres;
}

cv::Mat mask_of(const FrameInput& input, const Camera& camera) {
  if (input.mask.is_none()) return {};
  cv::Mat image = borrow("mask", array_named("mask", input.mask), CV_8UC1,
                         "bool or uint8 of shape (height, width), 0 on what is static");
  check_size("mask", image, camera);
  return input.copy ? image.clone() : image;
}

}  // namespace

RgbdFrame frame_of(const FrameInput& input, const Camera& camera) {
  if (!std::isfinite(input.depth_delay)) value_error("depth_delay is no number; give seconds");
  RgbdFrame frame;
  frame.timestamp = input.timestamp;
  frame.depth_delay = input.depth_delay;
  frame.colour = colour_of(input, camera);
  frame.depth = depth_of(input, camera);
  frame.mask = mask_of(input, camera);
  return frame;
}

RgbdFrame frame_of(const FrameInput& input, const Session& session) {
  const SlamConfig& config = session.config();
  check_timestamp(input.timestamp, session.last_timestamp());
  if (!input.mask.is_none() && config.dynamics.mode != DynamicsMode::masks) {
    value_error(fmt::format("mask: mode {} does not use masks; make the Config with mode=\"masks\"",
                            mode_info(config.dynamics.mode).name));
  }
  return frame_of(input, config.camera);
}

}  // namespace dkp_slam::python
