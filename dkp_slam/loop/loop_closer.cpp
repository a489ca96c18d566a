#include "dkp_slam/loop/loop_closer.h"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "dkp_slam/mapping/landmark_fusion.h"
#include "dkp_slam/tracking/relocalizer.h"

namespace dkp_slam {
namespace {

/// The keyframe as a frame that knows nothing of the map.
Frame frame_of(const Keyframe& k) {
  Frame frame;
  frame.index = k.frame_index;
  frame.timestamp = k.timestamp;
  frame.features = k.features;
  frame.is_static.assign(k.landmarks.size(), 1);
  frame.landmark.assign(k.landmarks.size(), -1);
  return frame;
}

/// The nearest ancestor in the spanning tree that is still in the map.
int live_parent(const Map& map, int keyframe) {
  int parent = map.keyframe(keyframe).parent;
  while (parent >= 0 && map.keyframe(parent).removed) parent = map.keyframe(parent).parent;
  return parent;
}

}  // namespace

std::optional<ClosedLoop> LoopCloser::close(Map& map, const PlaceIndex& places,
                                            const MeasurementModel& model, int keyframe) {
  for (const int old : detector_.detect(map, places, keyframe)) {
    Frame frame = frame_of(map.keyframe(keyframe));
    const int matches = localize_by_keyframe(map, model, options_.seed, old, frame);
    if (matches < options_.least_matches) {
      spdlog::debug("keyframe {}: no loop to keyframe {}, {} matches", keyframe, old, matches);
      continue;
    }
    const Se3 off = frame.camera_from_world * map.keyframe(keyframe).camera_from_world.inverse();
    const Se3 keyframe_from_old =
        frame.camera_from_world * map.keyframe(old).camera_from_world.inverse();
    loops_.push_back({old, keyframe, keyframe_from_old});
    correct(map);
    fuse(map, model, keyframe, frame);
    detector_.reset();
    closed_.push_back({keyframe, old, matches, off.translation.norm()});
    spdlog::info(
        "keyframe {}: loop to keyframe {} closed, {} matches, was {:.3f} m and {:.2f} deg off",
        keyframe, old, matches, off.translation.norm(), off.angle() * 180.0 / M_PI);
    return closed_.back();
  }
  return std::nullopt;
}

PoseGraph LoopCloser::essential_graph(const Map& map, std::vector<int>& node_of_keyframe) const {
  PoseGraph graph;
  node_of_keyframe.assign(static_cast<std::size_t>(map.keyframe_ids()), -1);
  for (int k = 0; k < map.keyframe_ids(); ++k) {
    if (map.keyframe(k).removed) continue;
    node_of_keyframe[static_cast<std::size_t>(k)] = static_cast<int>(graph.nodes.size());
    graph.nodes.push_back({map.keyframe(k).camera_from_world, graph.nodes.empty()});
  }
  const auto add = [&](int from, int to, const Se3& to_from_from, double weight) {
    graph.edges.push_back({node_of_keyframe[static_cast<std::size_t>(from)],
                           node_of_keyframe[static_cast<std::size_t>(to)], to_from_from, weight});
  };
  for (int k = 0; k < map.keyframe_ids(); ++k) {
    const Keyframe& keyframe = map.keyframe(k);
    if (keyframe.removed) continue;
    const auto add_present = [&](int other) {
      add(other, k, keyframe.camera_from_world * map.keyframe(other).camera_from_world.inverse(),
          1.0);
    };
    const int parent = live_parent(map, k);
    if (parent >= 0) add_present(parent);
    for (const auto& [other, shared] : keyframe.covisible) {
      if (other < k && other != parent && shared >= options_.least_shared) add_present(other);
    }
  }
  for (const LoopEdge& l : loops_) {
    if (!map.keyframe(l.from).removed && !map.keyframe(l.to).removed)
      add(l.from, l.to, l.to_from_from, options_.loop_weight);
  }
  return graph;
}

void LoopCloser::correct(Map& map) const {
  std::vector<int> node;
  const std::vector<Se3> poses = optimize_pose_graph(essential_graph(map, node), options_.graph);
  // A landmark moves with the first keyframe that sees it.
  for (int l = 0; l < map.landmark_ids(); ++l) {
    if (!map.has_landmark(l)) continue;
    Landmark& landmark = map.landmark(l);
    const int k = landmark.sightings.front().keyframe;
    const Se3& corrected = poses[static_cast<std::size_t>(node[static_cast<std::size_t>(k)])];
    landmark.position =
        corrected.inverse() * (map.keyframe(k).camera_from_world * landmark.position);
  }
  for (int k = 0; k < map.keyframe_ids(); ++k) {
    const int n = node[static_cast<std::size_t>(k)];
    if (n >= 0) map.keyframe(k).camera_from_world = poses[static_cast<std::size_t>(n)];
  }
  for (int l = 0; l < map.landmark_ids(); ++l) {
    if (map.has_landmark(l)) map.refresh(l);
  }
}

void LoopCloser::fuse(Map& map, const MeasurementModel& model, int keyframe,
                      const Frame& matched) const {
  const std::vector<int> neighbours = map.best_covisible(keyframe, options_.fused_neighbours);
  for (std::size_t f = 0; f < matched.landmark.size(); ++f) {
    const int old = map.resolve(matched.landmark[f]);
    if (old < 0) continue;
    const int present = map.keyframe(keyframe).landmarks[f];
    if (present == old) continue;
    if (present >= 0) {
      map.fuse_landmarks(present, old);
    } else if (map.landmark(old).feature_in(keyframe) < 0) {
      map.add_sighting(old, keyframe, static_cast<int>(f));
      map.refresh(old);
    }
  }
  map.update_covisibility(keyframe);
  fuse_with_neighbours(map, model, keyframe);
  map.update_covisibility(keyframe);
  for (const int n : neighbours) {
    map.update_covisibility(n);
    fuse_with_neighbours(map, model, n);
    map.update_covisibility(n);
  }
}

}  // namespace dkp_slam
