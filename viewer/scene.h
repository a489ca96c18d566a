#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/system/observer.h"
#include "viewer/frame_rows.h"
#include "viewer/fused_cloud.h"
#include "viewer/history.h"
#include "viewer/map_model.h"
#include "viewer/picture.h"
#include "viewer/truth.h"

namespace dkp_slam::viewer {

/// What a page is told of a run or a map as a whole.
struct SceneInfo {
  std::string kind = "run";                                ///< or "map"
  std::string title;                                       ///< what is played or shown
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value, to read
  std::optional<std::size_t> frames;                       ///< in all, where known
  Camera camera;
  Trajectory truth;  ///< empty where it is not known
};

/// What a page has already; see Scene::update.
struct PageState {
  std::string run;         ///< empty: nothing
  int frame = -1;          ///< the last one
  std::uint64_t path = 0;  ///< version of the path
  std::uint64_t map = 0;   ///< version of the map
  int message = 0;         ///< how many
};

/// Everything that pages show. The run puts in, pages take out what they lack; nothing is kept per
/// page, so that a slow one gets newer data and no queue. Any thread may call anything.
class Scene {
 public:
  explicit Scene(SceneInfo info);

  void add_frame(const std::shared_ptr<const FrameSnapshot>& snapshot);
  void add_keyframe(const KeyframeSnapshot& keyframe);
  void apply(const MapChange& change);
  /// `level`: "info", "warning" or "error".
  void add_message(const std::string& level, const std::string& text);
  /// The run is over: the path as it was adjusted at the end, by time, which takes the place of
  /// what was known frame by frame. Empty where there is none.
  void finish(const Trajectory& path);

  /// What `page` lacks, as a Container: see docs/view.md. `playback`: goes in as it is.
  std::string update(const PageState& page, const nlohmann::json& playback) const;
  PictureStore::Picture picture(std::optional<int> frame);
  /// The dense cloud is that of the run's dense map, instead of the keyframes' own.
  void show(std::shared_ptr<FusedCloud> fused);
  /// See there; null where the run fuses nothing (yet).
  std::shared_ptr<const std::string> fused_cloud(int map) const;
  /// Of a keyframe; null where none is kept.
  std::shared_ptr<const std::string> cloud(int keyframe) const;
  /// See TruthComparison::report; null where the truth is not known.
  std::shared_ptr<const std::string> error();

  /// Waits until there is anything after `tick`, or `timeout` has passed; the present tick.
  std::uint64_t wait(std::uint64_t tick, std::chrono::milliseconds timeout) const;
  /// Something that is not in the scene has changed, say a pause: wakes who waits.
  void touch();

 private:
  Trajectory path() const;

  const SceneInfo info_;
  const std::string run_;  // unlike that of any other
  TruthComparison truth_;
  PictureStore pictures_;
  mutable std::mutex mutex_;  // of what follows
  mutable std::condition_variable changed_;
  std::uint64_t tick_ = 1;
  bool finished_ = false;
  FrameRows frames_;
  MapModel map_;
  std::pair<int, std::shared_ptr<const std::string>> next_cloud_{-1, nullptr};  // by frame
  ThinnedHistory<std::shared_ptr<const std::string>> clouds_;                   // by keyframe
  std::shared_ptr<FusedCloud> fused_;
  struct Message {
    int number = 0;
    std::string level, text;
    int frame = -1;
  };
  std::deque<Message> messages_;
  int message_count_ = 0;
};

}  // namespace dkp_slam::viewer
