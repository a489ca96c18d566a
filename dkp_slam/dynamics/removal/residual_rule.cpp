#include "dkp_slam/dynamics/removal/residual_rule.h"

#include <cmath>

#include "dkp_slam/dynamics/removal/region_rules.h"

namespace dkp_slam {

bool ResidualRule::is_static(const FeatureDynamics& f, const Evidence& e) const {
  const bool known = f.tracked && !std::isnan(f.motion_residual);
  if (e.at_outline) return false;
  if (f.region == Region::low) return !known || f.motion_residual < options_.residual_low;
  if (f.region == Region::high && e.self_moving) return false;
  if (e.long_residual >= options_.residual_long) return false;  // false for NaN
  if (!e.self_moving) return !known || f.motion_residual < options_.residual_object;
  return known && f.motion_residual < options_.residual_suspicious;
}

void ResidualRule::classify(const RemovalInput& input,
                            std::vector<FeatureDynamics>& features) const {
  const std::vector<std::uint8_t> self_moving = on_self_moving(input);
  const cv::Mat outline =
      input.objects.empty() ? input.labels : masks_and_outlines(input.labels, options_.mask_margin);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Evidence evidence{self_moving[i] != 0, label_at(outline, input.points[i]) != 0,
                            input.motion.long_residual[i]};
    features[i].is_static = is_static(features[i], evidence);
  }
}

}  // namespace dkp_slam
