#include "dkp_slam/loop/essential_graph.h"

#include <algorithm>

namespace dkp_slam {

EssentialGraph::EssentialGraph(const Map& map, int which, const EssentialGraphOptions& options)
    : which_(which), options_(options), first_later_(map.keyframe_ids()) {}

bool EssentialGraph::gather(const Map& map, int ids) {
  const int end = std::min(first_later_, next_ + ids);
  for (; next_ < end; ++next_) {
    const Keyframe& k = map.keyframe(next_);
    if (!k.removed && k.map == which_) add(map, next_);
  }
  if (next_ < first_later_) return false;
  // All at one moment: a local adjustment between two pieces would bend what lies between them.
  for (const int k : keyframes_) poses_.push_back(map.keyframe_pose(k));
  return true;
}

void EssentialGraph::add(const Map& map, int keyframe) {
  keyframes_.push_back(keyframe);
  const Keyframe& k = map.keyframe(keyframe);
  int parent = k.parent;
  while (parent >= 0 && map.keyframe(parent).removed) parent = map.keyframe(parent).parent;
  if (parent >= 0) edges_.emplace_back(parent, keyframe);
  for (const auto& [other, shared] : k.covisible) {
    if (other >= keyframe) break;
    if (other != parent && shared >= options_.least_shared) edges_.emplace_back(other, keyframe);
  }
}

int EssentialGraph::node_of(int keyframe) const {
  const auto it = std::lower_bound(keyframes_.begin(), keyframes_.end(), keyframe);
  return it != keyframes_.end() && *it == keyframe ? static_cast<int>(it - keyframes_.begin()) : -1;
}

MapMove EssentialGraph::solve(const std::vector<LoopEdge>& loops, const PoseGraphOptions& options,
                              const std::atomic<bool>* stop) const {
  PoseGraph graph;
  for (const Se3& pose : poses_) graph.nodes.push_back({pose, graph.nodes.empty()});
  for (const auto& [from, to] : edges_) {
    const int a = node_of(from), b = node_of(to);
    if (a < 0 || b < 0) continue;
    const Se3 present =
        poses_[static_cast<std::size_t>(b)] * poses_[static_cast<std::size_t>(a)].inverse();
    graph.edges.push_back({a, b, present, 1.0});
  }
  for (const LoopEdge& l : loops) {
    const int a = node_of(l.from), b = node_of(l.to);
    if (a >= 0 && b >= 0) graph.edges.push_back({a, b, l.to_from_from, options_.loop_weight});
  }
  const std::vector<Se3> solved = optimize_pose_graph(graph, options, stop);
  MapMove move;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    move.keyframes.push_back({keyframes_[i], solved[i].inverse() * poses_[i], {}});
  }
  return move;
}

}  // namespace dkp_slam
