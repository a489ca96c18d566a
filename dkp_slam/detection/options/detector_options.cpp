#include "dkp_slam/detection/options/detector_options.h"

#include "dkp_slam/config/option_list.h"

namespace dkp_slam {

void DetectorOptions::describe(OptionList& list) {
  list.add("kind", kind,
           {{DetectorKind::automatic, "auto"},
            {DetectorKind::yolox, "yolox"},
            {DetectorKind::motion, "motion"},
            {DetectorKind::none, "none"}},
           "what finds objects that may move; auto: YOLOX where there is a model, else motion");
  list.add_part("yolox", yolox, "the network");
  list.add_part("motion", motion, "the detector that needs no model");
}

void DetectorOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
