#include "dkp_slam/dynamics/removal/epipolar_rule.h"

#include <cmath>

namespace dkp_slam {

bool EpipolarRule::is_static(const FeatureDynamics& f) const {
  if (!f.tracked || std::isnan(f.epipolar_distance)) return f.region == Region::low;
  return f.epipolar_distance * f.weight < epsilon_;
}

/// Fills D of Eq. 5.
void EpipolarRule::measure(const FeatureMotion& motion,
                           std::vector<FeatureDynamics>& features) const {
  PointMatches matches;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!features[i].tracked) continue;
    matches.current.push_back(motion.now[i]);
    matches.previous.push_back(motion.then[i]);
    matches.low.push_back(features[i].region == Region::low ? 1 : 0);
  }
  const auto fundamental = estimate_fundamental(matches, epipolar_);
  if (!fundamental) return;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!features[i].tracked) continue;
    features[i].epipolar_distance =
        static_cast<float>(epipolar_distance(*fundamental, motion.then[i], motion.now[i]));
  }
}

void EpipolarRule::classify(const RemovalInput& input,
                            std::vector<FeatureDynamics>& features) const {
  assign_weights(input.points, input.objects, input.labels, regions_, features);
  measure(input.motion, features);
  for (FeatureDynamics& f : features) f.is_static = is_static(f);
}

}  // namespace dkp_slam
