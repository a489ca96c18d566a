#include "dkp_slam/config/option_list.h"
#include "dkp_slam/dynamics/compensation/object_tracker.h"

namespace dkp_slam {

void ObjectTrackerOptions::describe(OptionList& list) {
  list.add("start_score", start_score, between(0, 1), "", "of a new object's detection");
  list.add("continue_score", continue_score, between(0, 1), "",
           "of a known object's detection, where the boxes agree");
  list.add("continue_iou", continue_iou, between(0, 1), "",
           "intersection over union by which they agree");
  list.add("carry_seconds", carry_seconds, at_least(0), "seconds",
           "that an object lives without a detection");
  list.add("carried_growth", carried_growth, at_least(1), "",
           "of a carried object's sides at most");
  list.add("leaving_share", leaving_share, between(0, 1), "",
           "of its box in the image; with less a carried object has left");
  list.add("duplicate_share", duplicate_share, between(0, 1), "",
           "of a carried box in a detected one, to be the same object");
  list.add("self_moving_weight", self_moving_weight, at_least(0), "",
           "class weight of what moves by itself: only it is carried");
  list.add("compensate", compensate, "carry objects over missed detections");
  list.order("continue_score", "start_score");
}

void ObjectTrackerOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
