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

cv::Mat square(int radius) {
  return cv::getStructuringElement(cv::MORPH_RECT, {2 * radius + 1, 2 * radius + 1});
}

std::ptrdiff_t remaining(const FrameDynamics& dynamics) {
  return std::count_if(dynamics.features.begin(), dynamics.features.end(),
                       [](const FeatureDynamics& f) { return f.is_static; });
}

void add(const OrbExtractor& extractor, const cv::Mat& allowed, OrbFeatures& features,
         FrameDynamics& dynamics) {
  const OrbFeatures more = extractor.extract_more(features, allowed);
  features.keypoints.insert(features.keypoints.end(), more.keypoints.begin(), more.keypoints.end());
  features.descriptors.insert(features.descriptors.end(), more.descriptors.begin(),
                              more.descriptors.end());
  dynamics.features.resize(features.keypoints.size());
}

}  // namespace

void FeatureRefillOptions::describe(OptionList& list) {
  list.add("below", below, at_least(0), "", "static features; an image with fewer gets more");
  list.add("features", features, between(50, 100000), "",
           "spread over what is not dynamic, with those that are known already");
  list.add("margin", margin, between(0, 100), "pixels", "from what is dynamic");
  list.add("known_below", known_below, at_least(0), "",
           "the same where surfaces were seen standing still before");
  list.add("known_features", known_features, between(50, 100000), "", "spread over these");
  list.add("known_inside", known_inside, between(0, 100), "pixels", "from what is not known");
}

void FeatureRefillOptions::check() const { check_options(*this); }

FeatureRefill::FeatureRefill(const OrbOptions& orb, const FeatureRefillOptions& options)
    : options_(options),
      extractor_(with_features(orb, options.features)),
      known_extractor_(with_features(orb, options.known_features)) {}

void FeatureRefill::refill(const Room& room, OrbFeatures& features, FrameDynamics& dynamics) const {
  if (dynamics.doubtful.empty()) return;
  if (remaining(dynamics) >= std::max(options_.below, options_.known_below)) return;
  cv::Mat hidden;
  cv::dilate(dynamics.doubtful, hidden, square(options_.margin));
  const cv::Mat free = hidden == 0;
  const std::size_t first = features.keypoints.size();
  if (remaining(dynamics) < options_.below) add(extractor_, free, features, dynamics);
  if (remaining(dynamics) < options_.known_below) {
    cv::Mat surfaces = room.known();
    if (!surfaces.empty()) {
      cv::erode(surfaces, surfaces, square(options_.known_inside));
      add(known_extractor_, free & surfaces, features, dynamics);
    }
  }
  if (features.keypoints.size() > first) room.judge(first);
}

}  // namespace dkp_slam
