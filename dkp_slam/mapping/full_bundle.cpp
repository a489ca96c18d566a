#include "dkp_slam/mapping/full_bundle.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "dkp_slam/localization/pose_refinement.h"

namespace dkp_slam {
namespace {

/// Where each of the items comes to lie when they are sorted.
template <class Item, class Before>
std::vector<int> sort_with_places(std::vector<Item>& items, Before before) {
  std::vector<int> order(items.size()), place(items.size());
  std::iota(order.begin(), order.end(), 0);
  const auto at = [&](int i) -> const Item& { return items[static_cast<std::size_t>(i)]; };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return before(at(a), at(b)); });
  std::vector<Item> sorted;
  sorted.reserve(items.size());
  for (const int i : order) {
    place[static_cast<std::size_t>(i)] = static_cast<int>(sorted.size());
    sorted.push_back(at(i));
  }
  items = std::move(sorted);
  return place;
}

}  // namespace

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
  const std::size_t enough = sightings < most_sightings_ - problem_.sightings.size()
                                 ? problem_.sightings.size() + sightings
                                 : most_sightings_;
  while (problem_.sightings.size() < enough) {
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
  const auto pose = static_cast<int>(problem_.poses.size());
  pose_of_[static_cast<std::size_t>(keyframe)] = pose;
  problem_.poses.push_back({keyframe, k.camera_from_world, false});
  for (std::size_t f = 0; f < k.landmarks.size(); ++f) {
    const int l = k.landmarks[f];
    if (l < 0) continue;
    const auto [point, is_new] =
        point_of_.try_emplace(l, static_cast<int>(problem_.points.size()));
    if (is_new) problem_.points.push_back({l, map.landmark(l).position});
    problem_.sightings.push_back(
        {pose, point->second, observation_of(k.features, static_cast<int>(f), map, model)});
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
      if (pose >= 0) problem_.poses[static_cast<std::size_t>(pose)].fixed = true;
    }
  }
}

BundleProblem FullBundle::take() && {
  auto& [poses, points, sightings] = problem_;
  const bool any_fixed =
      std::any_of(poses.begin(), poses.end(), [](const auto& p) { return p.fixed; });
  if (!poses.empty() && !any_fixed) {
    std::min_element(poses.begin(), poses.end(), [](const auto& a, const auto& b) {
      return a.keyframe < b.keyframe;
    })->fixed = true;
  }
  const std::vector<int> pose_place = sort_with_places(poses, [](const auto& a, const auto& b) {
    return std::tie(a.fixed, a.keyframe) < std::tie(b.fixed, b.keyframe);
  });
  const std::vector<int> point_place = sort_with_places(
      points, [](const auto& a, const auto& b) { return a.landmark < b.landmark; });
  for (BundleProblem::Sighting& s : sightings) {
    s.pose = pose_place[static_cast<std::size_t>(s.pose)];
    s.point = point_place[static_cast<std::size_t>(s.point)];
  }
  const auto keyframe = [&](const BundleProblem::Sighting& s) {
    return poses[static_cast<std::size_t>(s.pose)].keyframe;
  };
  std::sort(sightings.begin(), sightings.end(), [&](const auto& a, const auto& b) {
    return a.point != b.point ? a.point < b.point : keyframe(a) < keyframe(b);
  });
  return std::move(problem_);
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
