#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/map/keyframe.h"
#include "dkp_slam/map/landmark.h"

namespace dkp_slam {

/// Of the ids that a map gives: numbers in a file that are beyond these are wrong ones, and none
/// are written. Of landmarks 3000 a second come and go, so that it is a week of mapping, and where
/// one file is gone on with they are counted anew (with_new_landmark_ids).
inline constexpr int most_keyframe_ids = 10'000'000;
inline constexpr int most_landmark_ids = 1'900'000'000;

/// Why a map cannot have given so many ids, or nothing: one check for who reads a file and who
/// writes it.
std::optional<std::string> problem_of_counts(int keyframe_ids, int landmark_ids, int maps,
                                             int current_map);

/// What a map is made of, as plain values: all that cannot be computed from the rest.
struct MapParts {
  Camera camera;
  float level_scale = 1.2F;
  int levels = 8;
  int keyframe_ids = 0;  ///< ids given so far, those of removed ones among them
  int landmark_ids = 0;
  int maps = 1;
  int current_map = 0;
  /// Those in the map, by id. Of each: id, map, frame_index, timestamp, camera_from_world,
  /// features, landmarks, and as parent its nearest ancestor in the map or -1.
  std::vector<Keyframe> keyframes;
  /// Those in the map, by id. Of each: id, position, first_keyframe, visible, found and
  /// dynamic_log_odds.
  std::vector<Landmark> landmarks;

  /// Why these make no map, one line, or nothing when they do. Finds everything that would let the
  /// map's functions fail later: ids out of order or unknown, numbers that are not finite, lists
  /// of different length, a landmark seen twice by one keyframe or by none.
  std::optional<std::string> check() const;
};

/// The same map with its landmarks' ids counted from 0 anew, in their order. Nine in ten landmarks
/// go within seconds, and their ids with them.
MapParts with_new_landmark_ids(MapParts parts);

/// False for what no feature's place can be, NaN among it.
bool is_pixel(const cv::Point2f& point);

/// Both side by side, as maps of their own. What belongs to `b` gets other ids: keyframes,
/// landmarks and maps are counted on from those of `a`; ids of landmarks are new in both. Cameras
/// must be alike (see difference_of). New keyframes go to where they went in `b`.
MapParts merged(MapParts a, MapParts b);

/// What differs between two cameras so that a map made with one is none for the other, one line
/// with both values; nothing when they are alike. What only concerns the reading of images is left
/// out.
std::optional<std::string> difference_of(const Camera& a, const Camera& b);

}  // namespace dkp_slam
