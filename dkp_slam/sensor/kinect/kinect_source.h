#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/rgbd_source.h"

namespace dkp_slam {

struct KinectOptions {
  int number = 0;  ///< which of those that are plugged in, from 0
  /// Ends the taking of images, and every wait for them, when set. May be null.
  const std::atomic<bool>* stop = nullptr;
  /// Seconds without an image after which it is given up: it was unplugged and did not come back.
  double reconnect = 30.0;
  /// Seconds without an image after which it is opened anew.
  double silence = 3.0;
  /// Seconds between a colour and a depth image that still belong together, exclusive.
  double max_difference = 0.02;
};

/// Frames of a Kinect (the first one, of the Xbox 360) through libfreenect: 640 x 480, 30 Hz, depth
/// in millimetres registered to colour by the device's own calibration.
///
/// Images are taken by a thread of its own and paired by the device's stamps, counted on from the
/// host's clock at the first image. A pair that never came, by the stamps, or came while 30 waited
/// to be read is counted and said. When it is unplugged or falls silent, that is said, and it is
/// opened again until it is back; `read` throws when no image came for `KinectOptions::reconnect`;
/// when the stop flag is set it gives the pairs that came before, then nothing.
class KinectSource : public RgbdSource {
 public:
  /// To be called before the first `read`: depth outside the camera's range becomes 0. Its
  /// depth_scale is not used: a Kinect's is known. Throws `Error` when the images have another
  /// size.
  virtual void use_camera(const Camera& camera) = 0;
  /// Pairs that were lost so far.
  virtual std::size_t lost() const = 0;
};

/// "kinect", or "kinect:1" for the second one.
bool is_kinect(const std::string& name);

/// Throws `Error` where the name is no such.
int kinect_number(const std::string& name);

/// Whether the program was built with what reads a Kinect.
bool can_read_kinects();

/// Throws `Error` where there is none, it cannot be opened, or the program was built without
/// libfreenect.
std::unique_ptr<KinectSource> open_kinect(const KinectOptions& options = {});

}  // namespace dkp_slam
