#include "dkp_slam/config/option_list.h"
#include "dkp_slam/detection/motion/motion_detector.h"

namespace dkp_slam {

void EgoMotionOptions::describe(OptionList& list) {
  list.add("block", block, between(4, 256), "pixels",
           "of the half-size image; each such block gives its best corner");
  list.add("min_quality", min_quality, positive_share(), "",
           "response of a corner, as a share of the image's best");
  list.add("inlier_pixels", inlier_pixels, above(0), "pixels",
           "by which a static point may miss its predicted place");
  list.add("min_inlier_share", min_inlier_share, between(0, 1), "",
           "below it another start than the expected motion is tried");
  list.add("usual_shift", usual_shift, above(0), "metres",
           "change of the camera's motion from frame to frame");
  list.add("usual_turn", usual_turn, above(0), "radians",
           "change of the camera's motion from frame to frame");
  list.add("min_points", min_points, at_least(3), "", "matches with depth for a motion");
}

void EgoMotionOptions::check() const { check_options(*this); }

void BackgroundOptions::describe(OptionList& list) {
  list.add("tolerance", tolerance, at_least(0), "metres", "of the comparison with the background");
  list.add("tolerance_sigmas", tolerance_sigmas, at_least(0), "",
           "of the depth noise, added to the tolerance");
  list.add("blend", blend, between(0, 1), "", "of the new reading when a point is seen again");
  list.add("max_age", max_age, between(1, 255), "frames", "older points count as this old");
}

void BackgroundOptions::check() const { check_options(*this); }

void MotionEvidenceOptions::describe(OptionList& list) {
  list.add("min_residual", min_residual, at_least(0), "cells",
           "by which flow must miss the camera's own");
  list.add("residual_medians", residual_medians, at_least(0), "",
           "or this many times the image's median, whichever is more");
  list.add("min_texture", min_texture, at_least(0), "grey levels",
           "per cell, below which flow tells nothing");
  list.add("min_contrast", min_contrast, at_least(0), "grey levels",
           "by which the static prediction must look worse than the flow");
  list.add("depth_tolerance", depth_tolerance, between(0, 1), "",
           "share of the depth, for 'in front of' and 'behind'");
}

void MotionEvidenceOptions::check() const { check_options(*this); }

void MotionRegionOptions::describe(OptionList& list) {
  list.add("seed", seed, between(-100, 100), "log-odds", "from which a cell starts a region");
  list.add("grow", grow, between(-100, 100), "log-odds",
           "above which a cell may join a neighbour's region");
  list.add("reach", reach, at_least(0), "metres", "along the surface that a region grows");
  list.add("depth_cost", depth_cost, at_least(0), "",
           "metres that a metre of depth costs beyond its length");
  list.add("step", step, at_least(0), "metres", "in depth between neighbours that belong together");
  list.add("step_share", step_share, between(0, 1), "", "of the depth, added to the step");
  list.add("min_share", min_share, between(0, 1), "", "of the image; smaller regions are dropped");
  list.order("grow", "seed");
}

void MotionRegionOptions::check() const { check_options(*this); }

void MotionDetectorOptions::describe(OptionList& list) {
  list.add("columns", columns, between(16, 4096), "", "cells in a row of the grid");
  list.add("flow_interval", flow_interval, above(0), "seconds",
           "between the frames whose flow is compared");
  list.add("memory", memory, above(0), "seconds",
           "after which evidence that is not renewed has faded to 1/e");
  list.add("absorb_after", absorb_after, at_least(0), "seconds",
           "after which what stands still belongs to the background");
  list.add("known_age", known_age, at_least(1), "frames",
           "after which a cell counts in full for the camera's motion");
  list.add("max_gap", max_gap, above(0), "seconds",
           "between frames after which everything starts anew");
  list.add("came_gain", came_gain, at_least(0), "log-odds",
           "a frame at 30 Hz adds where free space was seen");
  list.add("moving_gain", moving_gain, at_least(0), "log-odds",
           "a frame adds where flow disagrees with the camera's motion");
  list.add("static_gain", static_gain, at_least(0), "log-odds",
           "a frame takes where flow agrees with it");
  list.add("same_gain", same_gain, at_least(0), "log-odds",
           "a frame takes where depth alone agrees");
  list.add("carry_step", carry_step, between(0, 1), "",
           "share of the depth by which a cell may differ from that its evidence comes from");
  list.add("keep_step", keep_step, between(0, 1), "",
           "the same where the camera's motion is unknown");
  list.add("limit", limit, above(0), "log-odds", "that evidence stays within");
  list.add_part("ego", ego, "the camera's own motion");
  list.add_part("planes", planes, "of the room, which tell the camera's motion from the start");
  list.add_part("static_planes", static_planes, "of these, remembered from frame to frame");
  list.add_part("background", background, "all static surfaces seen so far");
  list.add_part("evidence", evidence, "what flow says of a cell");
  list.add_part("regions", regions, "grown from the cells that moved");
}

void MotionDetectorOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
