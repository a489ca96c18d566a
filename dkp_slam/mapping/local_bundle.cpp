#include "dkp_slam/mapping/local_bundle.h"

#include <algorithm>

#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/map/id_map.h"

namespace dkp_slam {
namespace {

/// Keyframes outside the window that see most of the landmarks, best first.
std::vector<int> anchors_of(const Map& map, const std::vector<int>& window,
                            const std::vector<int>& landmarks, int count) {
  std::map<int, int> shared;
  for (const int l : landmarks) {
    for (const Sighting& s : map.landmark(l).sightings) ++shared[s.keyframe];
  }
  for (const int k : window) shared.erase(k);
  std::vector<std::pair<int, int>> order(shared.begin(), shared.end());
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  if (static_cast<int>(order.size()) > count) order.resize(static_cast<std::size_t>(count));
  std::vector<int> ids;
  for (const auto& [k, n] : order) ids.push_back(k);
  return ids;
}

BundleProblem snapshot(const Map& map, const MeasurementModel& model,
                       const std::vector<int>& moving, const std::vector<int>& fixed,
                       const std::vector<int>& landmarks) {
  BundleProblem problem;
  IdMap<int> index;  // into the poses
  const auto add_pose = [&](int k, bool stays) {
    index.insert(k, static_cast<int>(problem.poses.size()));
    problem.poses.push_back({k, map.keyframe(k).camera_from_world, stays});
  };
  for (const int k : moving) add_pose(k, false);
  for (const int k : fixed) add_pose(k, true);
  for (const int l : landmarks) {
    const Landmark& landmark = map.landmark(l);
    problem.points.push_back({l, landmark.position});
    for (const Sighting& s : landmark.sightings) {
      const int* pose = index.find(s.keyframe);
      if (!pose) continue;
      problem.sightings.push_back(
          {*pose, static_cast<int>(problem.points.size()) - 1,
           observation_of(map.keyframe(s.keyframe).features, s.feature, map, model)});
    }
  }
  return problem;
}

/// A keyframe that came after a snapshot, relative to its nearest ancestor in it.
struct LaterKeyframe {
  int keyframe, ancestor;
  Se3 from_ancestor;
};

/// A landmark that came after a snapshot, in the camera frame of the first keyframe that sees it.
struct LaterLandmark {
  int landmark, keyframe;
  Eigen::Vector3d position;
};

std::vector<LaterKeyframe> later_keyframes(const Map& map, const BundleProblem& problem,
                                           const std::vector<int>& keyframes) {
  IdSet known;
  for (const auto& p : problem.poses) {
    if (!map.keyframe(p.keyframe).removed) known.insert(p.keyframe);
  }
  std::vector<LaterKeyframe> later;
  for (const int k : keyframes) {
    if (known.contains(k)) continue;
    int ancestor = map.keyframe(k).parent;
    while (ancestor >= 0 && !known.contains(ancestor)) {
      ancestor = map.keyframe(ancestor).parent;
    }
    if (ancestor < 0) continue;
    later.push_back(
        {k, ancestor,
         map.keyframe(k).camera_from_world * map.keyframe(ancestor).camera_from_world.inverse()});
  }
  return later;
}

std::vector<LaterLandmark> later_landmarks(const Map& map, const BundleProblem& problem,
                                           const std::vector<int>& keyframes) {
  IdSet known;
  for (const auto& p : problem.points) known.insert(p.landmark);
  std::vector<LaterLandmark> later;
  for (const int l : map.landmarks_of(keyframes)) {
    if (known.contains(l)) continue;
    const int first = map.landmark(l).sightings.front().keyframe;
    later.push_back({l, first, map.keyframe(first).camera_from_world * map.landmark(l).position});
  }
  return later;
}

}  // namespace

BundleProblem local_bundle(const Map& map, const MeasurementModel& model, int keyframe,
                           const LocalBundleOptions& options) {
  std::vector<int> window = map.best_covisible(keyframe, options.window - 1);
  window.push_back(keyframe);
  const std::vector<int> landmarks = map.landmarks_of(window);
  std::vector<int> fixed = anchors_of(map, window, landmarks, options.anchors);
  // Something must hold the map in place: without anchors, the oldest of the window.
  if (fixed.empty()) {
    const auto oldest = std::min_element(window.begin(), window.end());
    fixed.push_back(*oldest);
    window.erase(oldest);
  }
  return snapshot(map, model, window, fixed, landmarks);
}

BundleProblem full_bundle(const Map& map, const MeasurementModel& model, int which) {
  const std::vector<int> all = map.keyframes_in(which);
  if (all.empty()) return {};
  return snapshot(map, model, {all.begin() + 1, all.end()}, {all.front()}, map.landmarks_of(all));
}

void apply_bundle(Map& map, const BundleProblem& problem, const BundleSolution& solution) {
  if (!solution.usable) return;
  for (const auto& p : solution.poses) {
    if (!p.fixed && !map.keyframe(p.keyframe).removed) {
      map.keyframe(p.keyframe).camera_from_world = p.camera_from_world;
    }
  }
  for (const auto& p : solution.points) {
    if (map.has_landmark(p.landmark)) map.landmark(p.landmark).position = p.position;
  }
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    if (!solution.outlier[i]) continue;
    const int landmark =
        problem.points[static_cast<std::size_t>(problem.sightings[i].point)].landmark;
    const int keyframe =
        problem.poses[static_cast<std::size_t>(problem.sightings[i].pose)].keyframe;
    if (!map.has_landmark(landmark) || map.keyframe(keyframe).removed) continue;
    map.remove_sighting(landmark, keyframe);
    if (map.has_landmark(landmark)) map.refresh(landmark);
  }
  for (const auto& p : solution.points) {
    if (map.has_landmark(p.landmark)) map.refresh_view(p.landmark);
  }
}

void adjust_map(Map& map, const MeasurementModel& model, int which, int iterations,
                const std::atomic<bool>* stop) {
  if (map.live_keyframes_in(which) < 2) return;
  BundleOptions options;
  options.iterations = iterations;
  const BundleProblem problem = full_bundle(map, model, which);
  apply_bundle(map, problem, adjust_bundle(map.camera(), model, problem, options, stop));
}

void apply_full_bundle(Map& map, const BundleProblem& problem, const BundleSolution& solution) {
  if (!solution.usable || problem.poses.empty()) return;
  const std::vector<int> all = map.keyframes_in(map.keyframe(problem.poses.front().keyframe).map);
  const std::vector<LaterKeyframe> keyframes = later_keyframes(map, problem, all);
  const std::vector<LaterLandmark> landmarks = later_landmarks(map, problem, all);
  apply_bundle(map, problem, solution);
  for (const LaterKeyframe& k : keyframes) {
    map.keyframe(k.keyframe).camera_from_world =
        k.from_ancestor * map.keyframe(k.ancestor).camera_from_world;
  }
  for (const LaterLandmark& l : landmarks) {
    if (!map.has_landmark(l.landmark)) continue;
    map.landmark(l.landmark).position =
        map.keyframe(l.keyframe).camera_from_world.inverse() * l.position;
  }
  for (const int l : map.landmarks_of(all)) map.refresh_view(l);
}

}  // namespace dkp_slam
