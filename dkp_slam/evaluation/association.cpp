#include "dkp_slam/evaluation/association.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

namespace dkp_slam {
namespace {

struct Candidate {
  double difference;
  std::size_t truth;
  std::size_t estimate;

  bool operator<(const Candidate& other) const {
    return std::tie(difference, truth, estimate) <
           std::tie(other.difference, other.truth, other.estimate);
  }
};

// Widens the search by more than rounding can move a stamp; the exact test comes after it.
constexpr double search_slack = 1e-3;

}  // namespace

std::vector<PoseMatch> associate(std::span<const StampedPose> truth,
                                 std::span<const StampedPose> estimate,
                                 const AssociationOptions& options) {
  std::vector<Candidate> candidates;
  const double reach = options.max_difference + search_slack;
  for (std::size_t e = 0; e < estimate.size(); ++e) {
    const double stamp = estimate[e].timestamp + options.offset;
    const auto first = std::partition_point(
        truth.begin(), truth.end(),
        [&](const StampedPose& pose) { return pose.timestamp < stamp - reach; });
    for (auto t = first; t != truth.end() && t->timestamp <= stamp + reach; ++t) {
      const double difference = std::abs(t->timestamp - stamp);
      if (difference < options.max_difference) {
        candidates.push_back({difference, static_cast<std::size_t>(t - truth.begin()), e});
      }
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> truth_used(truth.size(), false);
  std::vector<bool> estimate_used(estimate.size(), false);
  std::vector<PoseMatch> matches;
  for (const Candidate& candidate : candidates) {
    if (truth_used[candidate.truth] || estimate_used[candidate.estimate]) continue;
    truth_used[candidate.truth] = true;
    estimate_used[candidate.estimate] = true;
    matches.push_back({candidate.truth, candidate.estimate});
  }
  std::sort(matches.begin(), matches.end(),
            [](const PoseMatch& a, const PoseMatch& b) { return a.truth < b.truth; });
  return matches;
}

std::size_t nearest_index(std::span<const double> ascending, double wanted) {
  assert(!ascending.empty());
  std::size_t best = 0;
  double smallest = std::abs(ascending[0] - wanted);
  std::size_t begin = 0;
  std::size_t end = ascending.size();
  while (begin < end) {
    const std::size_t middle = begin + (end - begin) / 2;
    if (ascending[middle] == wanted) return middle;
    const double difference = std::abs(ascending[middle] - wanted);
    if (difference < smallest) {
      smallest = difference;
      best = middle;
    }
    if (ascending[middle] > wanted) {
      end = middle;
    } else {
      begin = middle + 1;
    }
  }
  return best;
}

std::vector<double> stamps_of(std::span<const StampedPose> poses) {
  std::vector<double> stamps;
  stamps.reserve(poses.size());
  for (const StampedPose& pose : poses) stamps.push_back(pose.timestamp);
  return stamps;
}

}  // namespace dkp_slam
