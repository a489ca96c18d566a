#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

/// One detected object.
struct Detection {
  cv::Rect2f box;      ///< pixels of the colour image, clipped to it
  int class_id = -1;   ///< COCO class from 0; `motion_class` for what moves and has no name
  float score = 0.0F;  ///< 0..1
  /// Dynamic weight W of the object's class, 1 (fixed, ignored) to 10 (a person); paper §3.5
  /// step 2.
  float weight = 10.0F;
  /// CV_8UC1, size of the box (rounded outwards), 255 on the object, when the detector knows the
  /// silhouette (the motion detector does); empty when it knows a box only.
  cv::Mat mask;

  static constexpr int motion_class = -2;
};

/// What a detector said, and of which image.
struct DetectionResult {
  double timestamp = 0.0;  ///< seconds, of the image that was looked at
  /// False while there is no answer (none yet, or no detector at all): nothing is known then, which
  /// is not the same as nobody there.
  bool answered = false;
  std::vector<Detection> detections;
};

/// Finds things that move or may move in one frame. Called with every frame that it looks at, in
/// order, from one thread; may keep state between frames. A detector that throws is replaced by
/// none by its caller.
class Detector {
 public:
  virtual ~Detector() = default;
  /// Name for reports: "yolox (ONNX Runtime, cpu)", "motion".
  virtual std::string name() const = 0;
  /// Whether it wants to look at this frame; false leaves the frame without an answer. Asked once
  /// for every frame, before `detect`.
  virtual bool looks_at(const RgbdFrame& /*frame*/) { return true; }
  /// Detections down to the configured lowest score: the tracker of missed detections continues
  /// known objects on weaker evidence than it starts new ones on (algorithm.md, §3.3).
  virtual std::vector<Detection> detect(const RgbdFrame& frame) = 0;
};

}  // namespace dkp_slam
