#pragma once

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "dkp_slam/system/observer.h"

namespace dkp_slam::python {

/// What a frame's snapshot tells beside its result; not the images, which go as soon as they may.
struct FrameDetails {
  cv::Size image;
  cv::Mat mask;
  std::vector<cv::KeyPoint> keypoints;
  std::vector<int> landmarks;
  std::vector<char> is_static;
  std::vector<DynamicObject> objects;
  DetectionResult detections;
};

/// Keeps the details of frames until their results are asked for, and tells who waits for frames.
/// Holds no Python object and never asks for the GIL.
class Arrivals final : public SlamObserver {
 public:
  /// Details wait for their results no longer than for so many newer ones: a mask and a thousand
  /// features each.
  static constexpr std::size_t most_kept = 64;

  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override;

  /// Of a frame; null where they were let go or never came.
  std::shared_ptr<const FrameDetails> take(int frame_index);
  /// Index of the newest frame so far, -1 for none.
  int newest() const;
  /// Waits until a frame newer than `newest` comes, `longest` seconds at most.
  void wait_for_newer_than(int newest, double longest) const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::map<int, std::shared_ptr<const FrameDetails>> details_;  // by frame index
  int newest_ = -1;
};

}  // namespace dkp_slam::python
