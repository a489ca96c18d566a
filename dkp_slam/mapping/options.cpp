#include "dkp_slam/config/option_list.h"
#include "dkp_slam/mapping/mapper.h"

namespace dkp_slam {

void LocalBundleOptions::describe(OptionList& list) {
  list.add("window", window, at_least(1), "", "keyframes that move");
  list.add("anchors", anchors, at_least(0), "", "keyframes that stay and hold the others");
}

void LocalBundleOptions::check() const { check_options(*this); }

void FullAdjustmentOptions::describe(OptionList& list) {
  list.add("iterations", iterations, between(1, 1000), "", "of the solver");
  list.add("delay", delay, at_least(1), "frames",
           "from its start until it is carried back, and one more per keyframe");
  list.add("most_sightings", most_sightings, at_least(1), "",
           "of a larger map only the part about the loop is adjusted");
  list.add("sightings_per_frame", sightings_per_frame, at_least(1), "",
           "that come into the snapshot in one frame");
  list.add("outliers_per_frame", outliers_per_frame, at_least(1), "",
           "that leave the map in one frame, after it");
}

void FullAdjustmentOptions::check() const { check_options(*this); }

void MapperOptions::describe(OptionList& list) {
  list.add("redundant_share", redundant_share, between(0, 1), "",
           "of a keyframe's landmarks that three others see as well, for it to go");
  list.add_part("local", local, "what a local bundle adjustment takes in");
  list.add_part("bundle", bundle, "its solver");
  list.add("bundle_delay", bundle_delay, at_least(1), "frames",
           "from a keyframe until its bundle adjustment is carried back");
  list.add_part("full", full, "bundle adjustment of a whole map, after a loop and at the end");
}

void MapperOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
