#pragma once

#include <cstdint>
#include <vector>

#include "dkp_slam/map/map.h"

namespace dkp_slam {

/// What of a keyframe may change after it was added.
struct KeyframeState {
  int id = -1;
  int map = 0;
  int frame_index = -1;
  double timestamp = 0.0;  ///< seconds
  Se3 camera_from_world;
  int parent = -1;             ///< nearest ancestor in the map, -1 for none
  std::vector<int> landmarks;  ///< per feature, -1 for none
};

/// What never changes.
struct KeyframeLooks {
  int id = -1;
  FrameFeatures features;
};

/// What of a landmark cannot be computed from the keyframes.
struct LandmarkState {
  int id = -1;
  Eigen::Vector3d position;  ///< world frame of its map, metres
  int first_keyframe = -1;
  int visible = 1, found = 1;
  float dynamic_log_odds = 0.0F;
};

/// What of a map is different from what a file holds, as values that another thread may have.
struct MapChange {
  std::vector<KeyframeState> keyframes;  ///< new and changed ones
  std::vector<KeyframeLooks> looks;      ///< of the new ones
  std::vector<int> removed_keyframes;
  std::vector<LandmarkState> landmarks;  ///< new and changed ones
  std::vector<int> removed_landmarks;
  bool counts_changed = false;  ///< one of the following
  int keyframe_ids = 0, landmark_ids = 0, maps = 1, current_map = 0;
  std::vector<int> live_maps;  ///< ids of maps that have keyframes, ascending

  bool empty() const {
    return keyframes.empty() && removed_keyframes.empty() && landmarks.empty() &&
           removed_landmarks.empty() && !counts_changed;
  }
};

/// Finds what changed in a map from call to call, by a 64-bit hash of every keyframe and landmark:
/// there are no flags that somebody might forget to set. Two states that differ in one number
/// never have the same hash; that two others have it by chance is 1 in 2^64.
class ChangeFinder {
 public:
  /// What changed since the last call; all there is at the first.
  MapChange find(const Map& map);

 private:
  void find_keyframes(const Map& map, MapChange& change);
  void find_landmarks(const Map& map, MapChange& change);
  void find_counts(const Map& map, MapChange& change);

  std::vector<std::uint64_t> keyframes_;  // by id; 0 for what is not there
  IdTable<std::uint64_t> landmarks_;
  bool first_ = true;
  int keyframe_ids_ = 0, landmark_ids_ = 0, maps_ = 1, current_map_ = 0;
  std::vector<int> live_maps_;
};

}  // namespace dkp_slam
