#include "dkp_slam/dynamics/removal/removal.h"

#include <cmath>

namespace dkp_slam {
namespace {

/// Algorithm 2. Features that flow cannot follow are kept outside boxes and dropped inside.
bool static_by_paper(const FeatureDynamics& f, const RemovalOptions& options) {
  if (!f.tracked || std::isnan(f.epipolar_distance)) return f.region == Region::low;
  return f.epipolar_distance * f.weight < options.epsilon;
}

bool static_by_motion(const FeatureDynamics& f, const FeatureEvidence& e,
                      const RemovalOptions& options) {
  const bool certain = e.object_weight >= options.certain_weight;
  const bool known = f.tracked && !std::isnan(f.motion_residual);
  if (e.at_outline) return false;
  if (f.region == Region::low) return !known || f.motion_residual < options.residual_low;
  if (f.region == Region::high && certain) return false;
  if (e.long_residual >= options.residual_long) return false;  // false for NaN
  if (!certain) return !known || f.motion_residual < options.residual_object;
  return known && f.motion_residual < options.residual_suspicious;
}

}  // namespace

void classify(DynamicsMode mode, const RemovalOptions& options,
              const std::vector<FeatureEvidence>& evidence,
              std::vector<FeatureDynamics>& features) {
  for (std::size_t i = 0; i < features.size(); ++i) {
    FeatureDynamics& f = features[i];
    const bool certain = evidence[i].object_weight >= options.certain_weight;
    switch (mode) {
      case DynamicsMode::off:
        f.is_static = true;
        break;
      case DynamicsMode::d:
        f.is_static = f.region == Region::low || !certain;
        break;
      case DynamicsMode::dk:
        f.is_static = f.region != Region::high || !certain;
        break;
      case DynamicsMode::dkp:
        f.is_static = static_by_paper(f, options);
        break;
      case DynamicsMode::dkp_plus:
        f.is_static = static_by_motion(f, evidence[i], options);
        break;
    }
  }
}

}  // namespace dkp_slam
