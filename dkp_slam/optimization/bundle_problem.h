#pragma once

#include <vector>

#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

/// A bundle adjustment as plain values: a snapshot of a part of the map, which another thread can
/// solve while the map goes on changing.
struct BundleProblem {
  struct Pose {
    int keyframe = -1;  ///< id in the map
    Se3 camera_from_world;
    bool fixed = false;
  };
  struct Point {
    int landmark = -1;  ///< id in the map
    Eigen::Vector3d position;
  };
  struct Sighting {
    int pose = -1;   ///< index into poses
    int point = -1;  ///< index into points
    Observation seen;
  };
  std::vector<Pose> poses;
  std::vector<Point> points;
  std::vector<Sighting> sightings;
};

struct BundleSolution {
  std::vector<BundleProblem::Pose> poses;    ///< the problem's, moved; `fixed` where held
  std::vector<BundleProblem::Point> points;  ///< the problem's, moved
  std::vector<char> outlier;                 ///< one per sighting
  bool usable = false;                       ///< false when stopped early or the solver failed
};

}  // namespace dkp_slam
