#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/mapping/landmark_fusion.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

/// A keyframe as a frame that knows nothing of the map, to be localised in it anew.
Frame frame_of(const Keyframe& keyframe);

/// Joins the map that a keyframe belongs to with the one that `old` belongs to: they show the same
/// place, and the keyframe's camera lies at `keyframe_from_old`. The younger of the two maps moves.
void join_map_of(Map& map, int keyframe, int old, const Se3& keyframe_from_old);

/// Makes one of the landmarks that a keyframe has and those that it was found to show, and looks
/// for more of that kind about its best neighbours, all of one map; piece by piece. Between the
/// pieces landmarks and keyframes may come and go.
class PlaceFusion {
 public:
  /// `seen`: per feature of the keyframe, the landmark that it was found to show, -1 for none.
  PlaceFusion(const Map& map, int keyframe, std::vector<int> seen, int neighbours);

  /// Goes on until it is done, which returns true, or until `effort` is used up (see
  /// landmark_fusion.h).
  bool advance(Map& map, const MeasurementModel& model, int effort);

 private:
  bool fuse_seen(Map& map, int& effort);

  int keyframe_;
  std::vector<int> seen_;
  std::size_t next_seen_ = 0;
  std::vector<int> around_;                // the keyframe and its neighbours
  std::size_t next_ = 0;                   // of these
  std::optional<NeighbourFusion> fusion_;  // about it, once begun
};

/// The same in one go.
void fuse_seen_again(Map& map, const MeasurementModel& model, int keyframe, std::vector<int> seen,
                     int neighbours);

}  // namespace dkp_slam
