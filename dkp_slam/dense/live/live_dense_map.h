#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "dkp_slam/dense/keyframe_fusion.h"
#include "dkp_slam/system/observer.h"

namespace dkp_slam {

struct LiveDenseOptions {
  KeyframeFusionOptions fusion;
  int width = 320;  ///< pixels: images are kept about so wide; 0.46 MB each at 4:3
  /// Keyframes whose images are kept, 2 or more. When there are more, every second one of the older
  /// half goes: what is long ago stays in wider steps.
  int keyframes = 400;
  bool live = false;    ///< SlamConfig::realtime of the run
  bool at_once = true;  ///< fuse from the beginning; else from when somebody looks
};

/// The static world, fused while a run lasts: an observer of the door that keeps the keyframes'
/// images with their masks and has a thread of its own, of low priority, that fuses them where the
/// map says they are now. Each of the atlas' maps has its own dense map. Keyframes of a stored map,
/// whose images nobody has, are left out.
///
///     auto dense = std::make_shared<LiveDenseMap>(config.camera, options);
///     slam.add_observer(dense, LiveDenseMap::watching());
///     ...
///     slam.finish();
///     dense->finish();
///     dense->look(dense->largest_map(), [](const KeyframeFusion& fused) { ... });
///
/// Offline the same run gives the same bytes: what is fused depends on what the observer is told
/// alone, which then comes at fixed frames; the run waits for the thread when it is behind. Live
/// nobody waits: what the thread had no time for is fused with what comes next.
///
/// Memory: the images, the voxels (DenseMapOptions::memory, of each map) and a quarter of that for
/// free space.
class LiveDenseMap : public SlamObserver {
 public:
  /// `camera`: of the run. Throws `Error` for options that make no sense.
  LiveDenseMap(const Camera& camera, const LiveDenseOptions& options);
  /// Drops what is not fused yet.
  ~LiveDenseMap() override;
  LiveDenseMap(const LiveDenseMap&) = delete;
  LiveDenseMap& operator=(const LiveDenseMap&) = delete;

  /// How it is to be added. `interval`: seconds from one change of the map to the next.
  static ObserverOptions watching(double interval = 2.0);

  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override;
  void on_keyframe(const KeyframeSnapshot& keyframe) override;
  void on_map(const MapChange& change) override;

  /// Waits until all that it was told of is fused. For any thread but the observer's, after
  /// Slam::finish. Throws what ended the fusing.
  void finish();
  /// Shows what is fused of a map, which stays as it is meanwhile; false where there is nothing
  /// (yet). Waits for a change that is under way. For any thread but the observer's. Throws what
  /// ended the fusing.
  bool look(int map, const std::function<void(const KeyframeFusion&)>& use);
  /// The map with the most keyframes whose images are there; 0 where there are none.
  int largest_map() const;
  /// Rises with every change that is fused.
  long version() const { return version_; }

 private:
  using Images = std::map<int, std::shared_ptr<const KeyframeImage>>;  // by keyframe
  using Maps = std::map<int, std::vector<PosedImage>>;
  struct Known {
    int map = 0;
    Se3 world_from_camera;
  };

  Vector6d velocity_of(const FrameSnapshot& snapshot) const;
  Maps maps_now() const;  // with the mutex held
  void ask();             // with the mutex held
  void work();
  void fuse(const Maps& maps);
  void rethrow_failure() const;

  const Camera camera_;  // of the kept images
  const LiveDenseOptions options_;

  // Of the observer's thread.
  std::optional<FrameResult> last_;
  std::pair<int, std::shared_ptr<const KeyframeImage>> next_{-1, nullptr};  // by frame

  mutable std::mutex mutex_;  // guards what follows, up to failure_
  std::condition_variable changed_;
  Images images_;
  std::map<int, Known> known_;
  std::optional<Maps> pending_;  // to be fused next
  bool wanted_, busy_ = false, closing_ = false;
  std::exception_ptr failure_;

  std::mutex work_mutex_;  // guards fusions_: held while one is changed or looked at
  std::map<int, std::unique_ptr<KeyframeFusion>> fusions_;

  std::atomic<long> version_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace dkp_slam
