#pragma once

#include <vector>

#include "dkp_slam/detection/class_table.h"
#include "dkp_slam/detection/detector.h"
#include "dkp_slam/synth/source.h"

namespace dkp_slam {

/// What a perfect detector says of a synthetic frame: the exact box of every actor that has a name
/// among COCO's classes, score 1. Things without a name are left out, as every detector must; so
/// are slivers of fewer than 100 pixels. Silhouettes come along with `masks`.
std::vector<Detection> true_detections(const SyntheticTruth& truth, const ClassTable& classes = {},
                                       bool masks = false);

}  // namespace dkp_slam
