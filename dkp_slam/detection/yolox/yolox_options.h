#pragma once

#include <filesystem>
#include <string>

#include "dkp_slam/detection/class_table.h"
#include "dkp_slam/detection/yolox/yolox_decode.h"

namespace dkp_slam {

/// Library that runs the network.
enum class YoloxBackend {
  automatic,    ///< ONNX Runtime where this build has it, else OpenCV
  onnxruntime,  ///< four times faster than OpenCV 4.6's dnn on one core
  opencv,       ///< always there
};

struct YoloxOptions {
  std::filesystem::path model;  ///< an official YOLOX export (.onnx) of any size
  YoloxBackend backend = YoloxBackend::automatic;
  /// Execution provider of ONNX Runtime: "cpu", "cuda" or "tensorrt". One that the installed
  /// ONNX Runtime does not offer gives a warning, and cpu runs.
  std::string provider = "cpu";
  /// Threads of the network. 1: on two cores tracking and mapping need the other one, and results
  /// do not depend on the number of cores.
  int threads = 1;
  yolox::DecodeOptions decode;
  ClassTable classes;
};

}  // namespace dkp_slam
