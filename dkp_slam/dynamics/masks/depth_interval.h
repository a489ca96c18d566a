#pragma once

#include <cstdint>

#include "dkp_slam/dynamics/masks/clustering_options.h"
#include "dkp_slam/dynamics/masks/kmeans.h"

namespace dkp_slam {

/// Metres, `high` exclusive. An unknown depth (0) is in none.
struct DepthInterval {
  float low = 0.0F;
  float high = 0.0F;
  bool holds(float z) const { return z > 0.0F && z >= low && z < high; }
};

/// Nearest depth, metres, around which at least a given share of the pixels gathers within
/// `thickness` metres; 0 when there is none.
float dominant_near_mode(const DepthHistogram& histogram, double min_share, double thickness);

/// The interval of depth that belongs to the object (paper Algorithm 1 and Eq. 1), from its mean
/// depth T in metres and the share R of its box that it fills. Puts K into `k_used`.
DepthInterval object_interval(const DepthHistogram& histogram, float mean_depth, float share,
                              const ClusteringOptions& options, std::uint64_t seed, int* k_used);

}  // namespace dkp_slam
