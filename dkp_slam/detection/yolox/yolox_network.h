#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "dkp_slam/detection/yolox/yolox_decode.h"
#include "dkp_slam/detection/yolox_options.h"

namespace dkp_slam {

/// A loaded YOLOX network, whatever library runs it.
class YoloxNetwork {
 public:
  virtual ~YoloxNetwork() = default;
  /// Library and provider for reports: "ONNX Runtime, cpu".
  virtual std::string name() const = 0;
  /// Size of the image it takes.
  virtual cv::Size input_size() const = 0;
  /// How it takes it.
  virtual yolox::InputLayout layout() const { return yolox::InputLayout::planes; }
  /// Where the next input goes: 3 * height * width floats.
  virtual float* input() = 0;
  /// Runs the network on `input()`. The result holds yolox::row_count rows of yolox::row_length
  /// floats and stays valid until the next call. Throws `Error` when the library fails.
  virtual const float* run() = 0;
};

/// Loads `model`, the bytes of the options' file or those cut to the images' size
/// (`yolox::cut_to_images`); throws `Error` when they are no model, or none of YOLOX.
std::unique_ptr<YoloxNetwork> load_yolox_opencv(const YoloxOptions& options,
                                                const std::string& model);
#ifdef DKP_SLAM_HAVE_ONNXRUNTIME
std::unique_ptr<YoloxNetwork> load_yolox_onnxruntime(const YoloxOptions& options,
                                                     const std::string& model);
#endif

}  // namespace dkp_slam
