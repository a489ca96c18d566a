#include "dkp_slam/config/option_list.h"
#include "dkp_slam/loop/loop_closer.h"

namespace dkp_slam {

void LoopDetectorOptions::describe(OptionList& list) {
  list.add("consistent", consistent, at_least(1), "",
           "keyframes in a row that must have seen the same other place");
  list.add("candidates", candidates, at_least(1), "", "keyframes that are looked at more closely");
  list.add("least_votes", least_votes, at_least(1), "", "of a keyframe that may close a loop");
  list.add("features_per_frame", features_per_frame, at_least(1), "",
           "of a keyframe that the place index is asked about in one frame");
}

void LoopDetectorOptions::check() const { check_options(*this); }

void LoopCloserOptions::describe(OptionList& list) {
  list.add_part("detector", detector, "notices that the camera is back where it was");
  list.add_part("graph", graph, "pose graph over the essential graph");
  list.add("least_matches", least_matches, at_least(3), "",
           "landmarks of the old place that the new keyframe must show");
  list.add("least_shared", edges.least_shared, at_least(1), "",
           "landmarks that make two keyframes an edge of the essential graph");
  list.add("loop_weight", edges.loop_weight, above(0), "", "of a loop's edge against all others");
  list.add("fused_neighbours", fused_neighbours, at_least(0), "",
           "keyframes about the new one whose landmarks are fused as well");
  list.add("delay", delay, at_least(0), "frames",
           "from the snapshot of the poses until the map is put right");
  list.add("keyframes_per_frame_of_delay", keyframes_per_frame_of_delay, at_least(1), "",
           "that make it one frame more");
  list.add("gathered_per_frame", gathered_per_frame, at_least(1), "",
           "keyframes that come into the snapshot in one frame");
  list.add("effort_per_frame", effort_per_frame, at_least(1), "us",
           "about, of fusing landmarks in one frame");
}

void LoopCloserOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
