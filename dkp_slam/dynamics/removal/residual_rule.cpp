#include "dkp_slam/dynamics/removal/residual_rule.h"

#include <algorithm>
#include <cmath>

#include "dkp_slam/dynamics/removal/region_rules.h"

namespace dkp_slam {

bool ResidualRule::is_static(const FeatureDynamics& f, const Evidence& e) const {
  if (e.at_outline || (f.region == Region::high && e.self_moving)) return false;
  if (f.region == Region::low) return true;
  const float noise = options_.noise_factor * e.noise;
  const bool moves = f.tracked && f.motion_residual >= std::max(options_.residual, noise);
  const bool moves_slowly = e.long_residual >= std::max(options_.residual_long, noise);
  return !moves && !moves_slowly;  // both false for NaN
}

void ResidualRule::classify(const RemovalInput& input,
                            std::vector<FeatureDynamics>& features) const {
  const std::vector<std::uint8_t> self_moving = on_self_moving(input);
  cv::Mat moving = input.labels.clone();
  for (std::size_t o = 0; o < input.objects.size(); ++o) {
    if (!input.objects[o].moves_by_itself) moving.setTo(0, moving == static_cast<int>(o) + 1);
  }
  const cv::Mat outline =
      input.objects.empty() ? moving : masks_and_outlines(moving, options_.mask_margin);
  const auto& camera_motion = input.motion.camera_motion;
  const float noise = camera_motion ? static_cast<float>(camera_motion->noise) : 0.0F;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Evidence evidence{self_moving[i] != 0, label_at(outline, input.points[i]) != 0, noise,
                            input.motion.long_residual[i]};
    features[i].is_static = is_static(features[i], evidence);
  }
}

}  // namespace dkp_slam
