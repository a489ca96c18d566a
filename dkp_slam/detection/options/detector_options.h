#pragma once

#include "dkp_slam/detection/motion/motion_detector.h"
#include "dkp_slam/detection/yolox_options.h"

namespace dkp_slam {

enum class DetectorKind {
  automatic,  ///< YOLOX where a model is found, else motion
  yolox,
  motion,
  none,
};

struct DetectorOptions {
  DetectorKind kind = DetectorKind::automatic;
  YoloxOptions yolox;  ///< an empty model path is filled in by `find_model`
  MotionDetectorOptions motion;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

}  // namespace dkp_slam
