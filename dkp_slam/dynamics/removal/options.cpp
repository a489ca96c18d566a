#include "dkp_slam/config/option_list.h"
#include "dkp_slam/dynamics/removal/epipolar.h"
#include "dkp_slam/dynamics/removal/regions.h"
#include "dkp_slam/dynamics/removal/removal_options.h"

namespace dkp_slam {

void EpipolarOptions::describe(OptionList& list) {
  list.add("inlier_distance", inlier_distance, above(0), "pixels", "of the 7-point RANSAC");
  list.add("confidence", confidence, between(0.5, 0.999999), "", "of the 7-point RANSAC");
  list.add("max_iterations", max_iterations, between(1, 100000), "", "of the 7-point RANSAC");
  list.add("min_low_matches", min_low_matches, at_least(0), "",
           "in low regions; with fewer all matches are used");
}

void EpipolarOptions::check() const { check_options(*this); }

void RegionOptions::describe(OptionList& list) {
  list.add("weight_low", weight_low, above(0), "", "W of low regions");
  list.add("weight_high", weight_high, above(0), "",
           "W in the mask of an object of class weight 10 (the paper's example: 10)");
  list.add("printed_equation", printed_equation,
           "Eq. 6 as printed: the low weight at the mask's edge, the high one far from it");
  list.order("weight_low", "weight_high");
}

void RegionOptions::check() const { check_options(*this); }

void RemovalOptions::describe(OptionList& list) {
  list.add("epsilon", epsilon, above(0), "pixels", "of Algorithm 2: static when D * W is below it");
  list.add("mask_margin", mask_margin, between(0, 100), "pixels",
           "from a mask; features nearer go with it");
  list.add("depth_margin", depth_margin, between(0, 100), "pixels",
           "from a mask; features nearer go with it where they are at its depth");
  list.add("depth_tolerance", depth_tolerance, between(0, 1), "",
           "share of the depth by which a feature at a mask's depth may differ from it");
  list.add("given_margin", given_margin, between(0, 100), "pixels",
           "from a mask that was given with the image; features nearer go with it");
  list.add("residual", residual, above(0), "pixels",
           "of a static point at most, in a box and outside its mask");
  list.add("residual_long", residual_long, above(0), "pixels", "the same, over the long baseline");
  list.add("noise_factor", noise_factor, at_least(0), "",
           "sigmas of the static points' residuals that a static point may be off");
  list.add("least_static", least_static, at_least(0), "features",
           "that are left at least: of those that are seen to move the least comes back first");
}

void RemovalOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
