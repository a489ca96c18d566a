#include "dkp_slam/mapping/full_bundle.h"

#include <algorithm>
#include <tuple>

#include "dkp_slam/localization/pose_refinement.h"

namespace dkp_slam {
FullBundle::FullBundle(const Map& map, int centre, std::size_t most_sightings)
    : which_(map.keyframe(centre).map),
      most_sightings_(most_sightings),
      met_(static_cast<std::size_t>(map.keyframe_ids()), 0),
      pose_of_(static_cast<std::size_t>(map.keyframe_ids()), -1),
      queue_{centre} {
  met_[static_cast<std::size_t>(centre)] = 1;
}

int FullBundle::next_keyframe(const Map& map) {
  while (true) {
    if (next_ < queue_.size()) return queue_[next_++];
    while (next_unconnected_ < first_later() && met_[static_cast<std::size_t>(next_unconnected_)])
      ++next_unconnected_;
    if (next_unconnected_ == first_later()) return -1;
    met_[static_cast<std::size_t>(next_unconnected_)] = 1;
    if (map.keyframe(next_unconnected_).map == which_) queue_.push_back(next_unconnected_);
  }
}

bool FullBundle::gather(const Map& map, const MeasurementModel& model, std::size_t sightings) {
  has_point_.resize(static_cast<std::size_t>(map.landmark_ids()), false);
  const std::size_t enough = sightings < most_sightings_ - sightings_.size()
                                 ? sightings_.size() + sightings
                                 : most_sightings_;
  while (sightings_.size() < enough) {
    const int k = next_keyframe(map);
    if (k < 0) return true;
    if (!map.keyframe(k).removed) take_in(map, model, k);
  }
  if (enough < most_sightings_) return false;
  cut_ = true;
  fix_rim(map);
  return true;
}

void FullBundle::take_in(const Map& map, const MeasurementModel& model, int keyframe) {
  const Keyframe& k = map.keyframe(keyframe);
  pose_of_[static_cast<std::size_t>(keyframe)] = static_cast<int>(poses_.size());
  poses_.push_back({keyframe, k.camera_from_world, false});
  for (std::size_t f = 0; f < k.landmarks.size(); ++f) {
    const int l = k.landmarks[f];
    if (l < 0) continue;
    sightings_.push_back(
        {keyframe, l, observation_of(k.features, static_cast<int>(f), map, model)});
    if (has_point_[static_cast<std::size_t>(l)]) continue;
    has_point_[static_cast<std::size_t>(l)] = true;
    points_.push_back({l, map.landmark(l).position});
  }
  for (const auto& [other, shared] : k.covisible) {
    if (other >= first_later() || met_[static_cast<std::size_t>(other)]) continue;
    met_[static_cast<std::size_t>(other)] = 1;
    queue_.push_back(other);
  }
}

void FullBundle::fix_rim(const Map& map) {
  for (std::size_t i = next_; i < queue_.size(); ++i) {
    for (const auto& [other, shared] : map.keyframe(queue_[i]).covisible) {
      const int pose = other < first_later() ? pose_of_[static_cast<std::size_t>(other)] : -1;
      if (pose >= 0) poses_[static_cast<std::size_t>(pose)].fixed = true;
    }
  }
}

BundleProblem FullBundle::take() && {
  BundleProblem problem;
  problem.poses = std::move(poses_);
  const auto older = [](const auto& a, const auto& b) { return a.keyframe < b.keyframe; };
  std::sort(problem.poses.begin(), problem.poses.end(), older);
  const bool any_fixed = std::any_of(problem.poses.begin(), problem.poses.end(),
                                     [](const auto& p) { return p.fixed; });
  if (!problem.poses.empty() && !any_fixed) problem.poses.front().fixed = true;
  std::stable_partition(problem.poses.begin(), problem.poses.end(),
                        [](const auto& p) { return !p.fixed; });
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    pose_of_[static_cast<std::size_t>(problem.poses[i].keyframe)] = static_cast<int>(i);
  }
  problem.points.assign(points_.begin(), points_.end());
  std::sort(problem.points.begin(), problem.points.end(),
            [](const auto& a, const auto& b) { return a.landmark < b.landmark; });
  std::sort(sightings_.begin(), sightings_.end(), [](const Seen& a, const Seen& b) {
    return std::tie(a.landmark, a.keyframe) < std::tie(b.landmark, b.keyframe);
  });
  problem.sightings.reserve(sightings_.size());
  std::size_t point = 0;
  for (const Seen& s : sightings_) {
    while (problem.points[point].landmark != s.landmark) ++point;
    problem.sightings.push_back(
        {pose_of_[static_cast<std::size_t>(s.keyframe)], static_cast<int>(point), s.seen});
  }
  return problem;
}

BundleProblem full_bundle(const Map& map, const MeasurementModel& model, int which,
                          std::size_t most_sightings) {
  const std::vector<int> all = map.keyframes_in(which);
  if (all.empty()) return {};
  FullBundle bundle(map, all.back(), most_sightings);
  bundle.gather(map, model, std::numeric_limits<std::size_t>::max());
  return std::move(bundle).take();
}

}  // namespace dkp_slam
