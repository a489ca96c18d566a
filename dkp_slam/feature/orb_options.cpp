#include "dkp_slam/config/option_list.h"
#include "dkp_slam/feature/orb_extractor.h"

namespace dkp_slam {

void OrbOptions::describe(OptionList& list) {
  list.add("features", features, between(50, 100000), "", "ORB features per image");
  list.add("levels", levels, between(1, 16), "", "levels of the image pyramid");
  list.add("scale", scale, between(1.01, 4.0), "", "between two levels");
  list.add("enlargement", enlargement, between(1, 4), "",
           "of images before corners are sought; level 0 is the enlarged one");
  list.add("fast_threshold", fast_threshold, between(1, 255), "grey levels", "of a FAST corner");
  list.add("fast_low_threshold", fast_low_threshold, between(1, 255), "grey levels",
           "where a cell of the image shows no corner at the first");
  list.order("fast_low_threshold", "fast_threshold");
}

void OrbOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
