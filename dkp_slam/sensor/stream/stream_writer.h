#pragma once

#include <vector>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/rgbd_frame.h"
#include "dkp_slam/sensor/stream/channel.h"

namespace dkp_slam {

/// A driver: sends frames to whoever reads a frame stream (docs/frame-stream.md), colour as bgr8,
/// depth as 16-bit units of the camera's `depth_scale`, as a camera's own depth image.
class StreamWriter {
 public:
  /// Of each frame by itself; `camera` goes into the header, whole.
  StreamWriter(ByteOutput& output, const Camera& camera);
  /// These return false when the output was stopped, and throw `Error` when the reader is gone.
  bool begin();
  /// Throws `Error` for images of another type or size than the camera's. Depth is rounded to
  /// units; what they do not reach becomes 0.
  bool write(const RgbdFrame& frame);
  /// Tells the reader that this is all.
  bool end();

 private:
  ByteOutput& output_;
  Camera camera_;
};

}  // namespace dkp_slam
