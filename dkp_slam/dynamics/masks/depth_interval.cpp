#include "dkp_slam/dynamics/masks/depth_interval.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace dkp_slam {
namespace {

/// Algorithm 1 line 4: half width of the depth interval around T that holds a share R.
float matched_half_width(const DepthHistogram& histogram, float mean_depth, float share) {
  const double wanted = static_cast<double>(share) * histogram.total();
  float half = histogram.bin_width();
  constexpr float widest = 1.0F;
  while (half < widest && histogram.count_between(mean_depth - half, mean_depth + half) < wanted) {
    half += histogram.bin_width();
  }
  return half;
}

}  // namespace

float dominant_near_mode(const DepthHistogram& histogram, double min_share, double thickness) {
  const auto reach = static_cast<int>(0.5 * thickness / histogram.bin_width());
  const double needed = min_share * histogram.total();
  int window = 0;
  for (int b = -reach; b < histogram.bins(); ++b) {  // b is the window's centre
    if (b + reach < histogram.bins()) window += histogram.count(b + reach);
    if (b - reach - 1 >= 0) window -= histogram.count(b - reach - 1);
    if (b < 0 || window <= 0 || window < needed) continue;
    // Slide on while the window still gains: its fullest place is the mode.
    int best = b, best_count = window;
    for (int c = b + 1; c <= b + 2 * reach && c < histogram.bins(); ++c) {
      if (c + reach < histogram.bins()) window += histogram.count(c + reach);
      if (c - reach - 1 >= 0) window -= histogram.count(c - reach - 1);
      if (window > best_count) {
        best = c;
        best_count = window;
      }
    }
    return histogram.centre(best);
  }
  return 0.0F;
}

DepthInterval object_interval(const DepthHistogram& histogram, float mean_depth, float share,
                              const ClusteringOptions& options, std::uint64_t seed, int* k_used) {
  const float half = matched_half_width(histogram, mean_depth, share);
  int k = 1;
  if (options.mode == ClusteringMode::paper) {
    const int n = std::max(1, DepthView::step * DepthView::step *
                                  histogram.count_between(mean_depth - half, mean_depth + half));
    const double raw_max = options.raw_depth_scale * static_cast<double>(histogram.max_value());
    constexpr double sane = 64.0;  // K of a mask of a few pixels would otherwise be thousands
    k = static_cast<int>(std::clamp(std::round(raw_max / n), 1.0, sane));
  } else if (options.mode == ClusteringMode::adaptive) {
    const double layers = static_cast<double>(histogram.max_value()) / (2.0 * half);
    k = static_cast<int>(std::clamp(std::round(layers), static_cast<double>(options.min_clusters),
                                    static_cast<double>(options.max_clusters)));
  } else {
    *k_used = 0;
    const auto band = static_cast<float>(options.band);
    return {mean_depth - band, mean_depth + band};
  }
  const std::vector<DepthCluster> clusters = kmeans(histogram, k, seed);
  *k_used = static_cast<int>(clusters.size());
  if (clusters.empty()) return {};
  const auto chosen = std::min_element(
      clusters.begin(), clusters.end(), [&](const DepthCluster& a, const DepthCluster& b) {
        return std::abs(a.centre - mean_depth) < std::abs(b.centre - mean_depth);
      });
  DepthInterval interval{chosen->low, chosen->high};
  if (options.mode == ClusteringMode::paper) return interval;
  for (const DepthCluster& c : clusters) {
    if (std::abs(c.centre - chosen->centre) > static_cast<float>(options.join_distance)) continue;
    interval.low = std::min(interval.low, c.low);
    interval.high = std::max(interval.high, c.high);
  }
  return interval;
}

}  // namespace dkp_slam
