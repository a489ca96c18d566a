#include "dkp_slam/dynamics/removal/region_rules.h"

namespace dkp_slam {
cv::Mat masks_of_self_moving(const RemovalInput& input) {
  cv::Mat moving = input.labels.clone();
  for (std::size_t o = 0; o < input.objects.size(); ++o) {
    if (!input.objects[o].moves_by_itself) moving.setTo(0, moving == static_cast<int>(o) + 1);
  }
  return moving;
}

cv::Mat FeatureClassifier::doubtful(const RemovalInput& input) const {
  if (input.objects.empty()) return {};
  cv::Mat area = input.labels.clone();
  const cv::Rect image(0, 0, area.cols, area.rows);
  for (const ObjectRegions& object : input.objects) area(cv::Rect(object.box) & image).setTo(255);
  return area;
}

std::vector<std::uint8_t> on_self_moving(const RemovalInput& input) {
  std::vector<std::uint8_t> on(input.points.size(), 0);
  for (std::size_t i = 0; i < on.size(); ++i) {
    const std::size_t label = label_at(input.labels, input.points[i]);
    for (std::size_t o = 0; o < input.objects.size() && on[i] == 0; ++o) {
      const ObjectRegions& object = input.objects[o];
      const bool belongs = label > 0 ? label == o + 1 : object.box.contains(input.points[i]);
      if (belongs && object.moves_by_itself) on[i] = 1;
    }
  }
  return on;
}

void BoxRule::classify(const RemovalInput& input, std::vector<FeatureDynamics>& features) const {
  const std::vector<std::uint8_t> self_moving = on_self_moving(input);
  for (std::size_t i = 0; i < features.size(); ++i) {
    features[i].is_static = features[i].region == Region::low || self_moving[i] == 0;
  }
}

void MaskRule::classify(const RemovalInput& input, std::vector<FeatureDynamics>& features) const {
  const cv::Mat moving = masks_of_self_moving(input);
  for (std::size_t i = 0; i < features.size(); ++i) {
    features[i].is_static = label_at(moving, input.points[i]) == 0;
  }
}

cv::Mat MaskRule::doubtful(const RemovalInput& input) const { return masks_of_self_moving(input); }

void GivenMaskRule::classify(const RemovalInput& input,
                             std::vector<FeatureDynamics>& features) const {
  const cv::Mat masks = masks_and_outlines(input.labels, margin_);
  for (std::size_t i = 0; i < features.size(); ++i) {
    features[i].is_static = label_at(masks, input.points[i]) == 0;
  }
}

cv::Mat GivenMaskRule::doubtful(const RemovalInput& input) const { return input.labels; }

}  // namespace dkp_slam
