#include "dkp_slam/dynamics/dynamics_options.h"

#include "dkp_slam/config/option_list.h"

namespace dkp_slam {

void DynamicsOptions::describe(OptionList& list) {
  list.leave_out();  // the mode: it stands above all parts
  list.add_part("clustering", clustering, "masks of objects (3.4)");
  list.add_part("mask_depth", mask_depth, "of two depth images, where a delay is known");
  list.add_part("static_planes", static_planes, "remembered from frame to frame");
  list.add_part("background", background, "known from before somebody came");
  list.add_part("compensation", compensation, "of missed detections (3.3)");
  list.add_part("history", history, "carries answers about earlier images");
  list.add_part("motion", motion, "of features against a static world");
  list.add_part("surfaces", surfaces, "that are seen to move");
  list.add_part("epipolar", epipolar, "the fundamental matrix of Algorithm 2");
  list.add_part("regions", regions, "weights of Eq. 6");
  list.add_part("removal", removal, "of dynamic features (3.5)");
}

void DynamicsOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
