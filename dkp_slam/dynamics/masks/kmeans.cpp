#include "dkp_slam/dynamics/masks/kmeans.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace dkp_slam {
namespace {

struct WeightedValue {
  double value;
  double weight;
};

/// Index drawn with a probability proportional to `mass`. Written out because the standard leaves
/// the algorithm of std::discrete_distribution to the library, and runs must repeat anywhere.
std::size_t draw(const std::vector<double>& mass, std::mt19937_64& random) {
  double sum = 0.0;
  for (double m : mass) sum += m;
  const double unit = static_cast<double>(random() >> 11U) * 0x1.0p-53;
  double left = unit * sum;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    left -= mass[i];
    if (left < 0.0) return i;
  }
  return mass.size() - 1;
}

std::vector<double> plus_plus_seeds(const std::vector<WeightedValue>& data, int k,
                                    std::mt19937_64& random) {
  std::vector<double> mass(data.size());
  std::transform(data.begin(), data.end(), mass.begin(),
                 [](const WeightedValue& d) { return d.weight; });
  std::vector<double> centres{data[draw(mass, random)].value};
  while (static_cast<int>(centres.size()) < k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      double nearest = std::abs(data[i].value - centres[0]);
      for (double c : centres) nearest = std::min(nearest, std::abs(data[i].value - c));
      mass[i] = data[i].weight * nearest * nearest;
      sum += mass[i];
    }
    if (sum <= 0.0) break;  // fewer distinct depths than clusters
    centres.push_back(data[draw(mass, random)].value);
  }
  std::sort(centres.begin(), centres.end());
  return centres;
}

}  // namespace

DepthHistogram::DepthHistogram(float bin, float max_depth)
    : bin_(bin), counts_(static_cast<std::size_t>(std::ceil(max_depth / bin)), 0) {}

void DepthHistogram::add(float depth) {
  const int bin = std::min(static_cast<int>(depth / bin_), bins() - 1);
  ++counts_[static_cast<std::size_t>(bin)];
  ++total_;
  max_value_ = std::max(max_value_, depth);
}

int DepthHistogram::count_between(float low, float high) const {
  const int first = std::clamp(static_cast<int>(low / bin_), 0, bins() - 1);
  const int last = std::clamp(static_cast<int>(high / bin_), 0, bins() - 1);
  int sum = 0;
  for (int b = first; b <= last; ++b) sum += count(b);
  return sum;
}

std::vector<DepthCluster> kmeans(const DepthHistogram& histogram, int k, std::uint64_t seed) {
  std::vector<WeightedValue> data;
  for (int b = 0; b < histogram.bins(); ++b) {
    if (histogram.count(b) > 0) {
      data.push_back({histogram.centre(b), static_cast<double>(histogram.count(b))});
    }
  }
  if (data.empty() || k < 1) return {};
  std::mt19937_64 random(seed);
  std::vector<double> centres = plus_plus_seeds(data, k, random);

  // Lloyd: in one dimension the clusters are the stretches between the centres' midpoints.
  std::vector<double> sum(centres.size()), weight(centres.size());
  constexpr int max_iterations = 100;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    std::fill(sum.begin(), sum.end(), 0.0);
    std::fill(weight.begin(), weight.end(), 0.0);
    std::size_t c = 0;
    for (const WeightedValue& d : data) {
      while (c + 1 < centres.size() && d.value > 0.5 * (centres[c] + centres[c + 1])) ++c;
      sum[c] += d.weight * d.value;
      weight[c] += d.weight;
    }
    bool moved = false;
    for (std::size_t i = 0; i < centres.size(); ++i) {
      if (weight[i] <= 0.0) continue;
      const double mean = sum[i] / weight[i];
      moved = moved || std::abs(mean - centres[i]) > 1e-6;
      centres[i] = mean;
    }
    if (!moved) break;
  }

  std::vector<DepthCluster> clusters;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (weight[i] <= 0.0) continue;
    DepthCluster cluster;
    cluster.centre = static_cast<float>(centres[i]);
    cluster.count = static_cast<int>(weight[i]);
    cluster.low = clusters.empty() ? 0.0F : 0.5F * (clusters.back().centre + cluster.centre);
    cluster.high = histogram.centre(histogram.bins() - 1) + histogram.bin_width();
    if (!clusters.empty()) clusters.back().high = cluster.low;
    clusters.push_back(cluster);
  }
  return clusters;
}

}  // namespace dkp_slam
