#pragma once

#include <vector>

#include <Eigen/Core>

#include "dkp_slam/feature/descriptor.h"

namespace dkp_slam {

class OptionList;

/// That a keyframe's feature shows a landmark.
struct Sighting {
  int keyframe = -1;
  int feature = -1;  ///< index into the keyframe's features
};

/// A static 3-D point of the map.
struct Landmark {
  int id = -1;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world frame, metres
  Descriptor descriptor{};                             ///< the sightings' most typical one
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< mean viewing direction, unit length
  /// Distances, metres, between which the pyramid's levels can show it.
  float min_distance = 0.0F, max_distance = 0.0F;
  std::vector<Sighting> sightings;  ///< ordered by keyframe
  int first_keyframe = -1;          ///< the one it was created by
  int visible = 1;                  ///< frames in whose view it lay
  int found = 1;                    ///< frames that matched it
  /// Running log-odds of being dynamic; see LandmarkBelief.
  float dynamic_log_odds = 0.0F;
  int followed_moves = 0;  ///< of the map's moves, that this landmark has followed; see Map::move

  /// Feature index by which a keyframe sees it, -1 if it does not.
  int feature_in(int keyframe) const {
    for (const Sighting& s : sightings) {
      if (s.keyframe == keyframe) return s.feature;
    }
    return -1;
  }
};

/// How evidence from single frames adds up in a landmark's log-odds, so that one bad frame neither
/// kills a good point nor keeps a bad one.
struct LandmarkBelief {
  float stayed = -0.3F;   ///< matched where it should be, and the feature called static
  float doubted = -0.1F;  ///< matched where it should be, but the feature called dynamic
  float strayed = 0.2F;   ///< matched elsewhere: a wrong match more often than a motion
  float moved = 0.9F;     ///< matched elsewhere, and the feature called dynamic
  float lowest = -2.5F, highest = 3.0F;  ///< bounds, so that a change of mind stays possible
  float dynamic_above = 1.5F;   ///< a landmark is dropped above it: at least two bad frames
  float trusted_below = -0.5F;  ///< and withstands a frame's verdict below it: two good frames

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

}  // namespace dkp_slam
