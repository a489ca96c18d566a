#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "dkp_slam/system/observer.h"
#include "viewer/container.h"

namespace dkp_slam::viewer {

/// The map as a page shows it: keyframes, which of them see the same, landmarks; each with the
/// version in which it changed last, so that a page gets what it does not have.
class MapModel {
 public:
  /// Landmarks that two keyframes must share to count as neighbours, as in the map itself.
  static constexpr int least_shared = 15;
  /// Neighbours of a keyframe that are told of.
  static constexpr std::size_t most_neighbours = 10;

  void add(const KeyframeSnapshot& keyframe);
  void apply(const MapChange& change);
  /// Rises with every change; 0 while there is none.
  std::uint64_t version() const { return version_; }
  std::size_t keyframes() const { return keyframes_.size(); }
  std::size_t landmarks() const { return landmarks_.size(); }

  /// What changed after `since`, all there is where that is too long ago: into `head`
  ///   map, map_reset: version, and whether what the page has is to go
  ///   keyframes: [{id, map, frame, time, pose: [x y z qx qy qz qw], parent, near: [id...]}]
  ///   gone_keyframes: [id...]
  /// and as sections landmark_ids, landmark_maps, gone_landmarks (int32) and landmark_positions
  /// (3 float32 each). Poses are world from camera, metres.
  void write(std::uint64_t since, nlohmann::json& head, Container& container) const;

 private:
  struct View {
    int map = 0, frame = -1, parent = -1;
    double time = 0.0;
    Se3 world_from_camera;
    std::vector<int> landmarks;               // each once
    std::vector<std::pair<int, int>> shared;  // neighbour, landmarks that both see
    std::uint64_t version = 0;
  };
  struct Point {
    float position[3];
    int first_keyframe = -1;
    std::uint64_t version = 0;
  };
  struct Gone {
    std::uint64_t version;
    int id;
  };

  void see(int keyframe, const std::vector<int>& landmarks);
  void forget_sightings(int keyframe, const View& view);
  void count_neighbours(int keyframe, View& view);
  void bury(std::deque<Gone>& gone, int id);
  int map_of(int id, const Point& point) const;

  std::uint64_t version_ = 0;
  std::uint64_t complete_since_ = 0;  // what went before this version is not known any more
  std::map<int, View> keyframes_;
  std::unordered_map<int, Point> landmarks_;
  std::unordered_map<int, std::vector<int>> seen_by_;  // landmark -> keyframes
  std::deque<Gone> gone_keyframes_, gone_landmarks_;
};

}  // namespace dkp_slam::viewer
