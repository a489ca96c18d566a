#include "dkp_slam/config/option_list.h"
#include "dkp_slam/map/landmark.h"

namespace dkp_slam {

void LandmarkBelief::describe(OptionList& list) {
  const char* const unit = "log-odds";
  list.add("stayed", stayed, between(-10, 10), unit, "matched in its place by a static feature");
  list.add("doubted", doubted, between(-10, 10), unit, "matched in its place by a dynamic feature");
  list.add("strayed", strayed, between(-10, 10), unit, "matched elsewhere by a static feature");
  list.add("moved", moved, between(-10, 10), unit, "matched elsewhere by a dynamic feature");
  list.add("lowest", lowest, between(-100, 0), unit, "that a landmark can come to");
  list.add("highest", highest, between(0, 100), unit, "that a landmark can come to");
  list.add("dynamic_above", dynamic_above, between(-100, 100), unit,
           "a landmark above it is removed");
  list.add("trusted_below", trusted_below, between(-100, 100), unit,
           "a landmark below it withstands a frame's verdict");
  list.order("trusted_below", "dynamic_above");
}

void LandmarkBelief::check() const { check_options(*this); }

}  // namespace dkp_slam
