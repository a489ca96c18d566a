#include "dkp_slam/dynamics/removal/residual_rule.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "dkp_slam/dynamics/removal/region_rules.h"
#include "dkp_slam/geometry/nearest_pixel.h"

namespace dkp_slam {

float ResidualRule::motion(const FeatureDynamics& f, float long_residual, float noise) const {
  const float least = options_.noise_factor * noise;
  float most = 0.0F;  // comparisons with NaN are false
  if (f.tracked && f.motion_residual > 0.0F) {
    most = f.motion_residual / std::max(options_.residual, least);
  }
  if (long_residual > 0.0F) {
    most = std::max(most, long_residual / std::max(options_.residual_long, least));
  }
  return most;
}

void ResidualRule::classify(const RemovalInput& input,
                            std::vector<FeatureDynamics>& features) const {
  const cv::Mat masks = masks_of_self_moving(input);
  cv::Mat outlines = masks;
  cv::Mat beside;
  if (!input.objects.empty()) {
    outlines = masks_and_outlines(masks, options_.mask_margin);
    beside = mask_depth_.candidates(masks);
  }
  const auto& camera_motion = input.motion.camera_motion;
  const float noise = camera_motion ? static_cast<float>(camera_motion->noise) : 0.0F;
  std::vector<std::pair<float, std::size_t>> moving;  // by how much they are seen to move
  std::ptrdiff_t left = 0;
  for (std::size_t i = 0; i < features.size(); ++i) {
    FeatureDynamics& f = features[i];
    f.is_static = label_at(outlines, input.points[i]) == 0;
    if (f.is_static) {
      const bool is_theirs =
          !beside.empty() && label_at(beside, input.points[i]) != 0 &&
          mask_depth_.is_shared(masks, input.depth, nearest_pixel(masks.size(), input.points[i]));
      const float moves = motion(f, input.motion.long_residual[i], noise);
      f.is_static = !is_theirs && (f.region == Region::low || moves < 1.0F);
      if (!f.is_static) moving.emplace_back(moves, i);
    }
    left += f.is_static ? 1 : 0;
  }
  if (!input.bring_back) return;
  // The pose needs some, and what moves least is most likely to stand still.
  std::sort(moving.begin(), moving.end());
  for (const auto& [moves, i] : moving) {
    if (left++ >= options_.least_static) break;
    features[i].is_static = true;
  }
}

cv::Mat ResidualRule::doubtful(const RemovalInput& input) const {
  return masks_of_self_moving(input);
}

}  // namespace dkp_slam
