#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/sensor/rgbd_source.h"
#include "dkp_slam/system/bounded_queue.h"

namespace dkp_slam {

/// A frame with all that can be said of it without knowing the frames before: what the threads
/// ahead of the tracker produce.
struct PreparedFrame {
  RgbdFrame frame;
  cv::Mat grey;  ///< CV_8UC1
  OrbFeatures orb;
  std::vector<Detection> detections;
  double decode_ms = 0.0, feature_ms = 0.0, detection_ms = 0.0;
};

struct FrontEndOptions {
  OrbOptions orb;
  /// Play the source by its time stamps, drop frames that come too late, and never wait for the
  /// detector: the newest finished result goes with the newest frame.
  bool realtime = false;
  /// Read a frame only when the one before has been taken and the next is asked for. Slower, but
  /// every stage has the machine to itself, so that its time is its own. Not with `realtime`.
  bool one_at_a_time = false;
};

/// Reading, feature extraction and detection, each in its own thread, ahead of the tracker.
///
/// Offline the stages form a line (read, features, detect) through queues of two frames, so every
/// frame gets its own detections and the result does not depend on timing. In real time the
/// detector works beside the line, on the newest frame.
///
/// A detector that throws is not called again; frames go on without detections.
class FrontEnd {
 public:
  /// `detector` may be null.
  FrontEnd(std::unique_ptr<RgbdSource> source, std::unique_ptr<Detector> detector,
           const FrontEndOptions& options);
  ~FrontEnd();
  FrontEnd(const FrontEnd&) = delete;
  FrontEnd& operator=(const FrontEnd&) = delete;

  /// The next frame; nothing at the end. Throws what the source or the feature extraction threw,
  /// after the frames before it, and again on every later call.
  std::optional<PreparedFrame> next();

  std::size_t skipped_frames() const { return skipped_frames_; }  ///< images that cannot be read
  int dropped_frames() const { return dropped_frames_; }          ///< too late in real time
  int detector_failures() const { return detector_failures_; }

 private:
  void read();
  void extract();
  void detect();
  void detect_newest();
  bool wait_until_due(double timestamp);
  std::vector<Detection> run_detector(const RgbdFrame& frame);
  void give_up_detector(int frame_index, const char* reason);

  const FrontEndOptions options_;
  std::unique_ptr<RgbdSource> source_;
  std::unique_ptr<Detector> detector_;
  BoundedQueue<char> asked_for_;  // a ticket per call of next(), where frames go one at a time
  BoundedQueue<PreparedFrame> read_, extracted_, detected_;
  BoundedQueue<RgbdFrame> newest_frame_;
  BoundedQueue<std::pair<std::vector<Detection>, double>> newest_detections_;
  std::exception_ptr source_error_, feature_error_;  // each written before its stage's queue closes
  std::atomic<std::size_t> skipped_frames_{0};
  std::atomic<int> dropped_frames_{0};
  std::atomic<int> detector_failures_{0};
  double first_timestamp_ = 0.0;
  std::optional<std::chrono::steady_clock::time_point> first_moment_;
  std::vector<std::thread> threads_;
};

}  // namespace dkp_slam
