#pragma once

#include <atomic>
#include <vector>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

class OptionList;

/// Poses and what is known of pairs of them.
struct PoseGraph {
  struct Node {
    Se3 camera_from_world;
    bool fixed = false;
  };
  struct Edge {
    int from = -1, to = -1;  ///< indices into nodes
    Se3 to_from_from;        ///< measured: camera `to` from camera `from`
    double weight = 1.0;     ///< its standard deviations are divided by this
  };
  std::vector<Node> nodes;
  std::vector<Edge> edges;
};

struct PoseGraphOptions {
  int iterations = 50;
  /// How far an edge may be off. Only their ratio matters while all edges are alike: 1 cm and half
  /// a degree are what two keyframes that share landmarks know of one another.
  double translation_sigma = 0.01;  ///< metres
  double rotation_sigma = 0.01;     ///< radians

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// The poses that agree best with the edges, in least squares on SE(3) (Ceres, on one thread, so
/// that it repeats exactly). Nodes that no edge reaches stay. Returns one pose per node; the
/// graph's own where the solver failed or `stop` was set.
std::vector<Se3> optimize_pose_graph(const PoseGraph& graph, const PoseGraphOptions& options = {},
                                     const std::atomic<bool>* stop = nullptr);

}  // namespace dkp_slam
