#pragma once

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

/// How a camera's pictures compare with those for which thresholds are written: 640 pixels wide and
/// 30 a second. For such a camera both are exactly 1, whatever its lens.
struct SensorScale {
  double pixels = 1.0;  ///< this camera's pixels in one pixel of a picture 640 wide
  double frames = 1.0;  ///< this camera's frames in a thirtieth of a second

  /// From the image's width and the camera's frame rate.
  static SensorScale of(const Camera& camera);

  /// A time that is given as frames of 30 Hz, in frames of this camera: at least one.
  int frames_of(int at_30_hz) const;
  /// Metres, radians or pixels from one frame to the next, of a motion that is given per frame at
  /// 30 Hz.
  double per_frame(double at_30_hz) const { return at_30_hz / frames; }
};

/// The same lens before an image of another size: scaled with the width; about the middle row cut
/// off, or more of it seen, where the shape differs. Depth keeps its noise in metres.
Camera resized(const Camera& camera, int width, int height);

}  // namespace dkp_slam
