#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/system/config.h"
#include "python/src/arrays.h"

namespace dkp_slam::python {

/// dkp_slam.Detection: what is detected, with a silhouette of the whole image's size.
struct DetectionObject {
  std::array<double, 4> box{};  ///< x, y, width, height, pixels
  int class_id = -1;
  double score = 0.0;
  double weight = 10.0;
  py::object mask = py::none();  ///< (height, width), bool or uint8
};

/// As the system has it: clipped to the image, the silhouette cut to its box; a box of no area
/// where nothing of it lies inside. Throws ValueError for a mask of another size.
Detection detection_of(const DetectionObject& object, const cv::Size& image);
/// And back: a silhouette over the whole image.
py::list detection_list(const std::vector<Detection>& detections, const cv::Size& image);

/// dkp_slam.Yolox and dkp_slam.RecordedDetections: a detector that may be used by itself and by
/// systems, of whom one calls at a time.
class SharedDetector {
 public:
  explicit SharedDetector(std::unique_ptr<Detector> detector) : detector_(std::move(detector)) {}
  std::string name() const { return detector_->name(); }
  std::vector<Detection> detect(const RgbdFrame& frame) {
    const std::lock_guard lock(mutex_);
    return detector_->detect(frame);
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<Detector> detector_;
};

/// What a detector written in Python threw, for whom it may concern: None as long as it has not.
/// Touched with the GIL only.
struct DetectorFailure {
  PyObject* exception = nullptr;
  ~DetectorFailure();
};

/// The detector that `wanted` stands for, with what was left open filled into `config`: None, a
/// name, a SharedDetector or a callable. Null for none. Throws `Error`, TypeError and ValueError.
std::unique_ptr<Detector> detector_of(const py::object& wanted, SlamConfig& config,
                                      const std::shared_ptr<DetectorFailure>& failure);

}  // namespace dkp_slam::python
