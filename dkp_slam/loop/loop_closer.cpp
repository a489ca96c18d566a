#include "dkp_slam/loop/loop_closer.h"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "dkp_slam/localization/relocalizer.h"
#include "dkp_slam/loop/place_joining.h"
#include "dkp_slam/map/map_snapshot.h"

namespace dkp_slam {

std::optional<ClosedLoop> LoopCloser::close(Map& map, const PlaceIndex& places,
                                            const MeasurementModel& model, int keyframe) {
  for (const int old : detector_.detect(map, places, keyframe)) {
    Frame seen = frame_of(map.keyframe(keyframe));
    const int matches = localize_by_keyframe(map, model, seed_, old, seen);
    if (matches < options_.least_matches) {
      spdlog::debug("keyframe {}: no loop to keyframe {}, {} matches", keyframe, old, matches);
      continue;
    }
    detector_.reset();
    ClosedLoop loop{keyframe, old, matches, 0.0,
                    map.keyframe(keyframe).map != map.keyframe(old).map};
    if (loop.joined_maps) {
      join(map, loop, seen);
    } else {
      put_right(map, loop, seen);
    }
    fuse_seen_again(map, model, keyframe, seen, options_.fused_neighbours);
    closed_.push_back(loop);
    return loop;
  }
  return std::nullopt;
}

void LoopCloser::join(Map& map, ClosedLoop& loop, const Frame& seen) const {
  join_map_of(map, loop.keyframe, loop.old_keyframe, seen);
  spdlog::info("keyframe {}: two maps joined at keyframe {}, {} matches", loop.keyframe,
               loop.old_keyframe, loop.matches);
}

void LoopCloser::put_right(Map& map, ClosedLoop& loop, const Frame& seen) {
  const Se3 off = seen.camera_from_world * map.keyframe(loop.keyframe).camera_from_world.inverse();
  const Se3 keyframe_from_old =
      seen.camera_from_world * map.keyframe(loop.old_keyframe).camera_from_world.inverse();
  loops_.push_back({loop.old_keyframe, loop.keyframe, keyframe_from_old});
  correct(map, map.keyframe(loop.keyframe).map);
  loop.moved = off.translation.norm();
  spdlog::info(
      "keyframe {}: loop to keyframe {} closed, {} matches, was {:.3f} m and {:.2f} deg off",
      loop.keyframe, loop.old_keyframe, loop.matches, loop.moved, off.angle() * 180.0 / M_PI);
}

PoseGraph LoopCloser::essential_graph(const Map& map, int which,
                                      std::vector<int>& node_of_keyframe) const {
  PoseGraph graph;
  node_of_keyframe.assign(static_cast<std::size_t>(map.keyframe_ids()), -1);
  const std::vector<int> keyframes = map.keyframes_in(which);
  const std::vector<int> ancestor = live_ancestors(map);
  for (const int k : keyframes) {
    node_of_keyframe[static_cast<std::size_t>(k)] = static_cast<int>(graph.nodes.size());
    graph.nodes.push_back({map.keyframe(k).camera_from_world, graph.nodes.empty()});
  }
  const auto add = [&](int from, int to, const Se3& to_from_from, double weight) {
    graph.edges.push_back({node_of_keyframe[static_cast<std::size_t>(from)],
                           node_of_keyframe[static_cast<std::size_t>(to)], to_from_from, weight});
  };
  for (const int k : keyframes) {
    const Keyframe& keyframe = map.keyframe(k);
    const auto add_present = [&](int other) {
      add(other, k, keyframe.camera_from_world * map.keyframe(other).camera_from_world.inverse(),
          1.0);
    };
    const int parent =
        keyframe.parent < 0 ? -1 : ancestor[static_cast<std::size_t>(keyframe.parent)];
    if (parent >= 0) add_present(parent);
    for (const auto& [other, shared] : keyframe.covisible) {
      if (other < k && other != parent && shared >= options_.least_shared) add_present(other);
    }
  }
  for (const LoopEdge& l : loops_) {
    if (node_of_keyframe[static_cast<std::size_t>(l.from)] >= 0 &&
        node_of_keyframe[static_cast<std::size_t>(l.to)] >= 0)
      add(l.from, l.to, l.to_from_from, options_.loop_weight);
  }
  return graph;
}

void LoopCloser::correct(Map& map, int which) const {
  std::vector<int> node;
  const std::vector<Se3> poses =
      optimize_pose_graph(essential_graph(map, which, node), options_.graph);
  const std::vector<int> keyframes = map.keyframes_in(which);
  const std::vector<int> landmarks = map.landmarks_of(keyframes);
  const auto corrected = [&](int k) -> const Se3& {
    return poses[static_cast<std::size_t>(node[static_cast<std::size_t>(k)])];
  };
  // A landmark moves with the first keyframe that sees it.
  for (const int l : landmarks) {
    const int k = map.landmark(l).sightings.front().keyframe;
    map.landmark(l).position =
        corrected(k).inverse() * (map.keyframe(k).camera_from_world * map.landmark(l).position);
  }
  for (const int k : keyframes) map.keyframe(k).camera_from_world = corrected(k);
  for (const int l : landmarks) map.refresh_view(l);
}

}  // namespace dkp_slam
