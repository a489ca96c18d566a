#pragma once

#include <atomic>
#include <vector>

#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/pose_graph.h"

namespace dkp_slam {

struct EssentialGraphOptions {
  int least_shared = 100;  ///< landmarks that make two keyframes an edge
  /// Of a loop's edge against all others. Those repeat one and the same drift many times, as
  /// neighbours at every distance, and would outvote it.
  double loop_weight = 30.0;
};

/// Where a keyframe lies to an older one, by what both show and not by the path from one to the
/// other.
struct LoopEdge {
  int from = -1, to = -1;  ///< keyframes
  Se3 to_from_from;
};

/// Snapshot of a map's keyframes and of what holds them together (Mur-Artal et al. 2015, section
/// III-D): the tree of parents, neighbours that share many landmarks, and loops. Taken piece by
/// piece, as values, and solved by another thread.
class EssentialGraph {
 public:
  EssentialGraph(const Map& map, int which, const EssentialGraphOptions& options = {});

  /// Goes through so many keyframe ids more; true when all are in. Poses are those of that moment.
  bool gather(const Map& map, int ids);

  int keyframes() const { return static_cast<int>(keyframes_.size()); }
  bool has(int keyframe) const { return node_of(keyframe) >= 0; }
  /// Ids of keyframes that came after the snapshot began begin with this one.
  int first_later() const { return first_later_; }

  /// How the keyframes move so that all edges, with those of the loops, agree best. Loops whose
  /// keyframes the graph does not have are left out. Nothing moves where `stop` was set.
  MapMove solve(const std::vector<LoopEdge>& loops, const PoseGraphOptions& options,
                const std::atomic<bool>* stop = nullptr) const;

 private:
  /// Index of a keyframe in the graph, -1 where it does not have it.
  int node_of(int keyframe) const;
  void add(const Map& map, int keyframe);

  int which_;
  EssentialGraphOptions options_;
  int first_later_;
  int next_ = 0;                            // keyframe id
  std::vector<int> keyframes_;              // the nodes, ascending
  std::vector<Se3> poses_;                  // camera_from_world, of each
  std::vector<std::pair<int, int>> edges_;  // keyframes
};

}  // namespace dkp_slam
