#include "dkp_slam/config/option_list.h"
#include "dkp_slam/optimization/bundle_adjustment.h"
#include "dkp_slam/optimization/observation.h"
#include "dkp_slam/optimization/pose_graph.h"

namespace dkp_slam {

void MeasurementModel::describe(OptionList& list) {
  list.add("pixel_sigma", pixel_sigma, above(0), "pixels",
           "noise of a corner on pyramid level 0; grows with the level's scale");
  list.add("depth_sigma_factor", depth_sigma_factor, above(0), "",
           "times the camera's formula for the noise of one depth reading");
  list.add("pixel_chi2", pixel_chi2, above(0), "", "an outlier's squared error in sigmas, pixel");
  list.add("depth_chi2", depth_chi2, above(0), "", "an outlier's squared error in sigmas, depth");
}

void MeasurementModel::check() const { check_options(*this); }

void BundleOptions::describe(OptionList& list) {
  list.add("iterations", iterations, between(1, 1000), "", "of the solver");
  list.add("drop_outliers", drop_outliers,
           "leave out sightings that are outliers after half of the iterations");
  list.add("least_shared", least_shared, at_least(0), "",
           "sightings of points that others see, too, of a pose that moves");
}

void BundleOptions::check() const { check_options(*this); }

void PoseGraphOptions::describe(OptionList& list) {
  list.add("iterations", iterations, between(1, 1000), "", "of the solver");
  list.add("translation_sigma", translation_sigma, above(0), "metres",
           "by which an edge may be off");
  list.add("rotation_sigma", rotation_sigma, above(0), "radians", "by which an edge may be off");
}

void PoseGraphOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
