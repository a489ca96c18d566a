#include "dkp_slam/config/option_list.h"
#include "dkp_slam/dynamics/motion/feature_motion.h"
#include "dkp_slam/dynamics/motion/moving_surfaces.h"

namespace dkp_slam {

void FlowOptions::describe(OptionList& list) {
  list.add("window_width", window_width, between(3, 101), "pixels", "of Lucas and Kanade's window");
  list.add("window_height", window_height, between(3, 101), "pixels",
           "of Lucas and Kanade's window");
  list.add("levels", levels, between(0, 10), "", "coarser pyramid levels");
  list.add("iterations", iterations, between(1, 1000), "", "on each level");
  list.add("epsilon", epsilon, above(0), "pixels", "a smaller step ends the iteration");
  list.add("forward_backward", forward_backward, above(0), "pixels",
           "from where a point began, tracked there and back");
  list.add("history", history, between(1, 100), "frames", "that are kept");
}

void FlowOptions::check() const { check_options(*this); }

void MotionOptions::describe(OptionList& list) {
  list.add("iterations", iterations, between(1, 100000), "", "three-point samples");
  list.add("max_scored", max_scored, at_least(3), "", "points a sample is scored on");
  list.add("inlier_distance", inlier_distance, above(0), "pixels", "of a static point");
  list.add("min_points", min_points, at_least(3), "", "fewer say nothing");
  list.add("min_inlier_share", min_inlier_share, between(0, 1), "",
           "of the points; below it the motion is not believed");
  list.add("acceleration", acceleration, above(0), "m/s^2", "of a camera in a hand, sigma");
  list.add("angular_acceleration", angular_acceleration, above(0), "rad/s^2",
           "of a camera in a hand, sigma");
}

void MotionOptions::check() const { check_options(*this); }

void FeatureMotionOptions::describe(OptionList& list) {
  list.add_part("flow", flow, "of features into earlier frames");
  list.add_part("motion", motion, "the camera's own, from that flow");
  list.add("coarse_rotation", coarse_rotation,
           "where the camera's motion is unknown, find its turn on small blurred images");
  list.add("long_baseline", long_baseline, above(0), "seconds",
           "over which slow motion is told from noise");
  list.add("depth_lag", depth_lag, between(0, 1), "",
           "share of a frame interval that colour and depth are apart at most");
  list.add("min_lag_pixels", min_lag_pixels, at_least(0), "pixels",
           "that an edge in depth is looked for at least");
  list.add("max_lag_pixels", max_lag_pixels, at_least(0), "pixels",
           "that an edge in depth is looked for at most");
  list.add("min_low_points", min_low_points, at_least(0), "",
           "outside the boxes; with fewer all points give the camera's motion");
  list.add("enough_outside", enough_outside, at_least(0), "",
           "features outside the boxes; with fewer those on static planes help");
  list.add("unmasked_distance", unmasked_distance, at_least(0), "pixels",
           "that a feature in a named box that no mask held may be off to help; 0: none helps");
  list.add("feature_sigma", feature_sigma, at_least(0), "pixels",
           "of what one feature tells about the camera's motion");
  list.add("followed_outside", followed_outside, at_least(0), "",
           "features followed outside the boxes of what moves by itself; 0: all");
  list.order("min_lag_pixels", "max_lag_pixels");
}

void FeatureMotionOptions::check() const { check_options(*this); }

void MovingSurfaceOptions::describe(OptionList& list) {
  list.add("moving_short", moving_short, at_least(0), "pixels",
           "residual of a feature that moves, from frame to frame");
  list.add("moving_long", moving_long, at_least(0), "pixels",
           "residual of a feature that moves, over the long baseline");
  list.add("still_long", still_long, at_least(0), "pixels",
           "residual of a feature that stands still, over the long baseline");
  list.add("noise_factor", noise_factor, at_least(0), "",
           "sigmas of the static points' residuals above which a feature moves");
  list.add("least_share", least_share, between(0, 1), "",
           "of the image that a moving surface takes to become an object");
  list.add("least_seconds", least_seconds, at_least(0), "seconds", "that it keeps moving");
  list.add("least_features", least_features, at_least(1), "", "that move on it");
  list.order("still_long", "moving_long");
}

void MovingSurfaceOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
