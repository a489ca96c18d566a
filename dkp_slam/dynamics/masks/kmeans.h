#pragma once

#include <cstdint>
#include <vector>

namespace dkp_slam {

/// Histogram of depths. In one dimension K-means on narrow bins equals K-means on the pixels to
/// within half a bin, at a hundredth of the cost.
class DepthHistogram {
 public:
  /// `bin` and `max_depth` in metres; deeper values are counted in the last bin.
  explicit DepthHistogram(float bin = 0.02F, float max_depth = 10.0F);
  void add(float depth);
  int total() const { return total_; }
  int bins() const { return static_cast<int>(counts_.size()); }
  int count(int bin) const { return counts_[static_cast<std::size_t>(bin)]; }
  float centre(int bin) const { return (static_cast<float>(bin) + 0.5F) * bin_; }
  float bin_width() const { return bin_; }
  /// Pixels with a depth in [low, high], metres, to within a bin.
  int count_between(float low, float high) const;
  /// Largest depth counted, metres; 0 when empty.
  float max_value() const { return max_value_; }

 private:
  float bin_;
  float max_value_ = 0.0F;
  int total_ = 0;
  std::vector<int> counts_;
};

/// One depth layer: in one dimension a cluster is an interval.
struct DepthCluster {
  float centre = 0.0F;  ///< mean depth, metres
  float low = 0.0F;     ///< metres, inclusive
  float high = 0.0F;    ///< metres, exclusive
  int count = 0;        ///< pixels
};

/// K-means++ (Arthur and Vassilvitskii 2007) on a depth histogram, then Lloyd's iterations until
/// no centre moves. Returns at most `k` clusters in the order of their depth, none empty; fewer
/// where there are fewer distinct depths. The same seed gives the same clusters.
std::vector<DepthCluster> kmeans(const DepthHistogram& histogram, int k, std::uint64_t seed);

}  // namespace dkp_slam
