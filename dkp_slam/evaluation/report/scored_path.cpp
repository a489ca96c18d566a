#include "dkp_slam/evaluation/report/scored_path.h"

#include <algorithm>

namespace dkp_slam {

double start_of(std::span<const ScoredPath> paths) {
  double start = paths.front().estimate.front().timestamp;
  for (const ScoredPath& path : paths) start = std::min(start, path.estimate.front().timestamp);
  return start;
}

Trajectory truth_during(std::span<const StampedPose> truth, std::span<const ScoredPath> paths,
                        const AssociationOptions& association) {
  double begin = start_of(paths), end = begin;
  for (const ScoredPath& path : paths) end = std::max(end, path.estimate.back().timestamp);
  begin += association.offset - association.max_difference;
  end += association.offset + association.max_difference;
  Trajectory during;
  for (const StampedPose& pose : truth) {
    if (pose.timestamp >= begin && pose.timestamp <= end) during.push_back(pose);
  }
  return during;
}

}  // namespace dkp_slam
