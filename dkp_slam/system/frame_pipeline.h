#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/detection/startle.h"
#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/sensor/rgbd_frame.h"
#include "dkp_slam/system/bounded_queue.h"

namespace dkp_slam {

/// A frame with all that can be said of it without knowing the frames before: what the threads
/// ahead of the tracker produce.
struct PreparedFrame {
  RgbdFrame frame;
  cv::Mat grey;  ///< CV_8UC1
  OrbFeatures orb;
  DetectionResult detections;
  double feature_ms = 0.0, detection_ms = 0.0;
  std::chrono::steady_clock::time_point fed;  ///< when it came in
  bool startling = false;                     ///< live: what was seen before may not hold any more
};

/// Frames between two stages. More would even out little and hold 2.5 MB each at 640 x 480.
inline constexpr int line_capacity = 1;

/// The same before the tracker of a live camera, whose frames wait for 45 ms and no longer: two at
/// 30 Hz, three at 60. A frame in which much is asked (a keyframe, somebody who steps in) takes
/// longer than the next one's interval there, and those after it make up for it.
inline constexpr int live_capacity = 3;

/// Frames that come in while the detector does not answer, offline: in the lines before it and in
/// the two stages.
inline constexpr int room_before_answer = 2 * line_capacity + 2;

/// Feature extraction and detection, each in its own thread, between whoever feeds frames and the
/// tracker.
///
/// Offline the stages form a line (features, detections) through queues of one frame, so every
/// frame gets its own detections and the result does not depend on timing. Live the detector works
/// beside the line, on the newest frame, and frames that come too fast are dropped, the oldest
/// first; while that happens the detector looks half as often. A frame into which somebody may have
/// stepped (the first, after a gap, or much is nearer than all about it was) waits for its own
/// answer, 50 ms at most: else people would be the room.
///
/// A detector that throws is not called again; frames go on without detections.
class FramePipeline {
 public:
  /// `detector` may be null. `startling`: as `least` of `Startle`.
  FramePipeline(std::unique_ptr<Detector> detector, const OrbOptions& orb, bool live,
                double startling = startling_share);
  ~FramePipeline();
  FramePipeline(const FramePipeline&) = delete;
  FramePipeline& operator=(const FramePipeline&) = delete;

  /// Offline waits for room, live never. False once the pipeline has ended.
  bool push(RgbdFrame frame);
  /// No frames will come any more; those under way do.
  void close_input() { incoming_.close(); }
  /// Ends at once: nothing comes any more, not even what was under way.
  void stop();
  /// The next frame; nothing at the end. Throws what ended a stage (the feature extraction threw,
  /// memory ran out), after the frames before it, and again on every later call.
  std::optional<PreparedFrame> next();

  int dropped_frames() const { return dropped_frames_; }  ///< live, too late
  int detector_failures() const { return detector_failures_; }

 private:
  void end();
  /// A stage, to its end; what it throws is noted, and nothing more comes in.
  void run(void (FramePipeline::*stage)());
  void extract();
  void detect();
  void detect_newest();
  DetectionResult run_detector(const RgbdFrame& frame);
  void rest(std::chrono::steady_clock::time_point began);
  void take_answer(PreparedFrame& frame);
  void give_up_detector(int frame_index, const char* reason);

  const OrbOptions orb_;
  const bool live_;
  std::unique_ptr<Detector> detector_;
  std::atomic<bool> detecting_;  // there is a detector that has not failed
  Startle startle_;
  BoundedQueue<PreparedFrame> incoming_, extracted_, detected_;
  BoundedQueue<RgbdFrame> newest_frame_;
  BoundedQueue<char> startled_;  // wakes the detector from its rest
  BoundedQueue<std::pair<DetectionResult, double>> newest_detections_;
  std::mutex error_mutex_;
  std::exception_ptr error_;  // the first that ended a stage; written before its queue closes
  std::atomic<int> dropped_frames_{0};
  // Of the detector's thread alone: how many of those it knows of, and until when it looks less
  // often for them.
  int dropped_before_ = 0;
  std::chrono::steady_clock::time_point late_until_;
  std::atomic<int> detector_failures_{0};
  std::vector<std::thread> threads_;
};

}  // namespace dkp_slam
