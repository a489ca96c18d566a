#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>

#include <nlohmann/json.hpp>

#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/system/observer.h"
#include "viewer/container.h"
#include "viewer/history.h"

namespace dkp_slam::viewer {

/// What is known of every frame, as numbers. A frame's pose hangs on the keyframe that it was found
/// by: where a closed loop, a merge or an adjustment moves that one, the frame moves along.
class FrameRows {
 public:
  /// Numbers per frame, float32: index, seconds since the first frame, localised, state, map,
  /// position (3), rotation (x, y, z, w), features, removed, landmarks, detections, carried
  /// objects, keyframe, milliseconds of decode, features, detection, masks, removal, tracking and
  /// the whole frame.
  static constexpr std::size_t columns = 25;
  /// Numbers of a frame that moved: index, map, position (3), rotation (x, y, z, w).
  static constexpr std::size_t moved_columns = 9;

  FrameRows();

  void add(const FrameResult& result);
  void add(const KeyframeSnapshot& keyframe);
  void apply(const MapChange& change);
  /// The path as it was adjusted at the end, by time, in place of what is known frame by frame.
  void finish(const Trajectory& path);

  /// Of the frames in the newest one's map; positions alone.
  Trajectory path() const;
  /// Index of the newest frame, -1 for none.
  int newest() const;
  /// Time stamp of the first frame; 0 where there is none.
  double start() const { return start_.value_or(0.0); }

  /// What a page lacks that has the frames up to `frame`, as they lay at `version` (nothing: that
  /// has none): into `head`
  ///   path, path_reset: version, and whether what the page has is to go
  ///   newest, more: the newest frame, and whether there are more of them than are told now
  /// and as sections frames and moved (see columns).
  void write(int frame, std::optional<std::uint64_t> version, nlohmann::json& head,
             Container& container) const;

 private:
  using Row = std::array<float, columns>;
  using Pose = std::array<float, 7>;  // position, rotation (x, y, z, w)
  struct Frame {
    Row row;
    int reference = -1;          // keyframe, -1 for none
    Pose camera_from_reference;  // single precision: there are many
    std::uint64_t version = 0;   // that moved it last, 0 for none
  };
  struct Keyframe {
    int map = 0;
    Se3 world_from_keyframe;
    Se3 placed;  // where the frames that hang on it take it to be
  };
  struct Heir {
    int keyframe = -1;
    Se3 old_from_heir;
  };

  static Row row_of(const FrameResult& result, double start);
  static Pose pose_of(const Se3& pose);
  static Se3 se3_of(const Pose& pose);
  static void place(Row& row, const Se3& world_from_camera);
  /// Who takes over the frames of keyframes that go.
  std::unordered_map<int, Heir> heirs_of(const MapChange& change) const;
  /// Those that lie elsewhere now, or in another map.
  std::unordered_map<int, Keyframe> take_moves(const MapChange& change);

  std::optional<double> start_;
  std::uint64_t version_ = 0;
  ThinnedHistory<Frame> frames_;
  std::map<int, Keyframe> keyframes_;
};

}  // namespace dkp_slam::viewer
