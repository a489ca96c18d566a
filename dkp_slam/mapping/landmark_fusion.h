#pragma once

#include <cstddef>
#include <vector>

#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

/// Looks for a keyframe's landmarks in its neighbours and for theirs in it: a feature without a
/// landmark gets the sighting, two landmarks in one place become one (Mur-Artal et al. 2015,
/// §VI-C).
void fuse_with_neighbours(Map& map, const MeasurementModel& model, int keyframe);

/// What work on landmarks takes, so that a frame can do a bounded part of it: about a microsecond
/// is 1.
namespace effort {
constexpr int search = 1;      ///< for a landmark in a keyframe
constexpr int fusion = 20;     ///< of two landmarks, or a sighting more
constexpr int keyframe = 200;  ///< whose neighbours are counted anew, or whose landmarks listed
}  // namespace effort

/// The same piece by piece. Between the pieces landmarks and keyframes may come and go.
class NeighbourFusion {
 public:
  NeighbourFusion(const Map& map, int keyframe);

  /// Goes on until it is done, which returns true, or until `effort`, which it takes its work off,
  /// is used up.
  bool advance(Map& map, const MeasurementModel& model, int& effort);

 private:
  bool fuse(Map& map, const MeasurementModel& model, int into, int& effort);

  int keyframe_;
  std::vector<int> others_;     // its neighbours
  std::size_t step_ = 0;        // others to look in first, then the keyframe itself
  bool listed_ = false;         // landmarks_ are those of this step
  std::vector<int> landmarks_;  // to look for
  std::size_t next_ = 0;        // of these
};

}  // namespace dkp_slam
