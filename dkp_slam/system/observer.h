#pragma once

#include <memory>

#include "dkp_slam/loop/loop_closer.h"
#include "dkp_slam/map/map_changes.h"
#include "dkp_slam/system/frame_result.h"

namespace dkp_slam {

/// A keyframe as it was inserted.
struct KeyframeSnapshot {
  int id = -1;
  int map = 0;
  int frame_index = -1;
  double timestamp = 0.0;  ///< seconds
  Se3 world_from_camera;
  int landmarks = 0;  ///< it sees
};

/// The camera was lost with this frame, or found again.
struct TrackingChange {
  int frame_index = -1;
  double timestamp = 0.0;  ///< seconds
  double lost_for = 0.0;   ///< seconds since the first lost frame
};

/// Is told what happens, on a thread of its own that is not the tracker's: it may take its time and
/// may throw (which is logged and counted), without slowing or ending the run. All arguments are
/// snapshots that nobody changes afterwards. Calls come one at a time and in order.
class SlamObserver {
 public:
  virtual ~SlamObserver() = default;

  virtual void on_frame(const std::shared_ptr<const FrameSnapshot>&) {}
  virtual void on_keyframe(const KeyframeSnapshot&) {}
  /// What changed in the map since the last call, see ObserverOptions::map.
  virtual void on_map(const MapChange&) {}
  virtual void on_loop(const ClosedLoop&) {}
  virtual void on_maps_merged(const ClosedLoop&) {}
  virtual void on_lost(const TrackingChange&) {}
  virtual void on_found(const TrackingChange&) {}
};

/// What happens while an observer is busy.
enum class Delivery {
  /// Frames that it cannot keep up with are left out: it gets the newest. Never slows the system.
  newest,
  /// Offline it gets every frame, changes of the map at fixed ones (`map_interval` is the frames'
  /// own), and the tracker waits when it is `inbox` behind. Live nobody waits, and the oldest go.
  every,
};

struct ObserverOptions {
  Delivery delivery = Delivery::newest;
  std::size_t inbox = 8;  ///< events that wait at most, `newest` takes 64
  /// Send changes of the map, too: they take some time of the tracking thread, 1 to 5 ms each.
  bool map = false;
  double map_interval = 0.5;  ///< seconds from one change to the next, at least
};

}  // namespace dkp_slam
