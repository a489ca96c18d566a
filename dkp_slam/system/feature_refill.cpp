#include "dkp_slam/system/feature_refill.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/config/option_list.h"

namespace dkp_slam {
namespace {

OrbOptions with_features(OrbOptions orb, int features) {
  orb.features = features;
  return orb;
}

}  // namespace

void FeatureRefillOptions::describe(OptionList& list) {
  list.add("below", below, at_least(0), "", "static features; an image with fewer gets more");
  list.add("features", features, between(50, 100000), "",
           "spread over what is not dynamic, with those that are known already");
  list.add("margin", margin, between(0, 100), "pixels", "from what is dynamic");
}

void FeatureRefillOptions::check() const { check_options(*this); }

FeatureRefill::FeatureRefill(const OrbOptions& orb, const FeatureRefillOptions& options)
    : options_(options), extractor_(with_features(orb, options.features)) {}

void FeatureRefill::refill(const cv::Mat& grey, OrbFeatures& features,
                           FrameDynamics& dynamics) const {
  if (dynamics.doubtful.empty()) return;
  const auto remaining = std::count_if(dynamics.features.begin(), dynamics.features.end(),
                                       [](const FeatureDynamics& f) { return f.is_static; });
  if (remaining >= options_.below) return;
  const int side = 2 * options_.margin + 1;
  cv::Mat hidden;
  cv::dilate(dynamics.doubtful, hidden, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  const OrbFeatures more = extractor_.extract_more(grey, features, hidden == 0);
  features.keypoints.insert(features.keypoints.end(), more.keypoints.begin(), more.keypoints.end());
  features.descriptors.insert(features.descriptors.end(), more.descriptors.begin(),
                              more.descriptors.end());
  dynamics.features.resize(features.keypoints.size());
}

}  // namespace dkp_slam
