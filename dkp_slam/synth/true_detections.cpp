#include "dkp_slam/synth/true_detections.h"

namespace dkp_slam {

std::vector<Detection> true_detections(const SyntheticTruth& truth, const ClassTable& classes,
                                       bool masks) {
  constexpr int sliver = 100;  // pixels
  std::vector<Detection> detections;
  for (const SyntheticObject& object : truth.objects) {
    const auto class_id = ClassTable::find(object.class_name);
    if (!class_id || object.pixels < sliver) continue;
    Detection d;
    d.box = object.box;
    d.class_id = *class_id;
    d.score = 1.0F;
    d.weight = classes.weight(*class_id);
    if (masks) d.mask = truth.instance(object.box) == object.instance;
    detections.push_back(d);
  }
  return detections;
}

}  // namespace dkp_slam
