#pragma once

#include <filesystem>
#include <string>

#include "dkp_slam/detection/class_table.h"
#include "dkp_slam/detection/look_schedule.h"

namespace dkp_slam {

class OptionList;

namespace yolox {

struct DecodeOptions {
  /// Weaker boxes are dropped. Objects are continued down to this score and started on more.
  float lowest_score = 0.10F;
  /// Of two boxes of one class that overlap by more than this IoU the weaker one goes. The value
  /// of YOLOX's own demo.
  float nms_iou = 0.45F;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

}  // namespace yolox

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
  LookOptions looks;
  yolox::DecodeOptions decode;
  ClassTable classes;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

}  // namespace dkp_slam
