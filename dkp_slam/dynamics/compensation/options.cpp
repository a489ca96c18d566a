#include "dkp_slam/config/option_list.h"
#include "dkp_slam/dynamics/compensation/motion_history.h"
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
  list.add("few_sightings", few_sightings, at_least(0), "",
           "detections; a carried object with no more gives way to a better one within it");
  list.add("self_moving_weight", self_moving_weight, at_least(0), "",
           "class weight of what moves by itself: only it is carried");
  list.add("compensate", compensate, "carry objects over missed detections");
  list.add("longest_delay", longest_delay, at_least(0), "seconds",
           "answers about images longer ago tell nothing about now");
  list.order("continue_score", "start_score");
}

void ObjectTrackerOptions::check() const { check_options(*this); }

void MotionHistoryOptions::describe(OptionList& list) {
  list.add("depth_reach", depth_reach, above(0), "metres",
           "from the object's depth within which what lies in its box belongs to it");
  list.add("least_layer_share", least_layer_share, between(0, 1), "",
           "of a box's central half; a near layer that fills less is something in front");
}

void MotionHistoryOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
