#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/sensor/rgbd_frame.h"
#include "dkp_slam/system/config.h"
#include "dkp_slam/system/frame_result.h"
#include "dkp_slam/system/observer.h"

namespace dkp_slam {

/// What a run came to so far.
struct SlamCounters {
  int fed = 0;                ///< frames taken
  int answered = 0;           ///< of which there is a result
  int dropped = 0;            ///< live: too late
  int detector_failures = 0;  ///< 1: it threw, and is not called any more
  int forgotten_results = 0;  ///< nobody polled them in time
  int observer_exceptions = 0;
  int observer_drops = 0;  ///< events that a slow observer missed
};

/// The door of the system: colour and depth images in, poses out, everything else to observers.
///
///     Slam slam(config, std::move(detector));
///     while (auto frame = source->read()) {
///       slam.feed(std::move(*frame));
///       while (auto result = slam.poll()) use(*result);
///     }
///     slam.finish();
///     save(slam.trajectory());
///
/// Offline (`config.realtime` false) `feed` waits for room, nothing is dropped, and the same frames
/// with the same configuration give the same bytes, however fast or busy the machine. Live
/// (`realtime`) `feed` returns at once; what comes too fast is dropped, the oldest frame first,
/// and counted; nobody waits for the detector, whose newest answer counts.
///
/// Threads: features, detection, tracking and every observer run in threads of their own. `feed`
/// and `finish` are called by one thread at a time, `poll` and `wait` by one (the same or another),
/// `counters` by any at any time. Observers are added before the first frame. The map and the
/// trajectories belong to the tracking thread until `finish` has returned; asking for them before
/// throws.
class Slam {
 public:
  /// `detector` may be null: then nothing but motion tells what is dynamic. `stored`: a map to
  /// start from, made with this camera. Throws `Error` for a configuration that makes no sense.
  explicit Slam(const SlamConfig& config, std::unique_ptr<Detector> detector = nullptr,
                std::optional<Map> stored = std::nullopt);
  /// Without `finish`: stops as soon as the frame under way is done.
  ~Slam();
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  void add_observer(std::shared_ptr<SlamObserver> observer, const ObserverOptions& options = {});

  /// Takes a frame: colour CV_8UC3 (BGR) and depth CV_32FC1 (metres, 0 unknown) of the camera's
  /// size; in mode masks also somebody's segmentation of that size (RgbdFrame::mask), which no
  /// detector then replaces. The images must not be written to afterwards; pixels that are not
  /// cv::Mat's own are copied. An index that does not count on from the last frame's is replaced by
  /// one that does. Throws `Error` for a frame of the wrong type or size or whose time stamp is not
  /// after the last one's, which then changes nothing; after `finish`; and where the system itself
  /// has failed.
  void feed(RgbdFrame frame);
  /// The next result, in the frames' order; nothing when there is none yet. Results that nobody
  /// asks for are kept for ten minutes of a 30 Hz camera. Throws what ended the system early, after
  /// the results before it.
  std::optional<FrameResult> poll();
  /// Offline: waits for the next result; nothing when all frames fed so far have theirs. Throws as
  /// `poll`.
  std::optional<FrameResult> wait();

  /// No more frames: finishes those that were fed, ends adjustments and does the final one unless
  /// `stop` is set before that is done, and lets the observers have what is left for them.
  void finish(const std::atomic<bool>* stop = nullptr);

  SlamCounters counters() const;

  /// After `finish`. Poses of all localised frames, by time, with everything known at the end: one
  /// path per map that any were localised in, each in its own world frame, the longest first.
  std::vector<Trajectory> trajectories() const;
  /// The longest of them.
  Trajectory trajectory() const;
  /// Poses of this run's keyframes in the map of the longest path.
  Trajectory keyframe_trajectory() const;
  const Map& map() const;
  /// Loops closed and maps merged.
  const std::vector<ClosedLoop>& loops() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dkp_slam
