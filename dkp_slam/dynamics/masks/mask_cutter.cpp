#include "dkp_slam/dynamics/masks/mask_cutter.h"

namespace dkp_slam {

std::string MaskCutter::name() const {
  switch (options_.mode) {
    case ClusteringMode::paper:
      return "masks by Algorithm 1";
    case ClusteringMode::band:
      return "masks by a band of depth";
    default:
      return "masks by clusters and surfaces";
  }
}

}  // namespace dkp_slam
