#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/rgbd_source.h"
#include "dkp_slam/sensor/stream/channel.h"

namespace dkp_slam {

struct StreamOptions {
  ChannelOptions channel;
  /// Seconds that a socket waits for a driver to come back after it was cut off.
  double reconnect = 30.0;
  /// Hand on the masks that the stream brings (RgbdFrame::mask); else they are left out.
  bool masks = false;
};

/// Frames of a driver: a pipe, or a socket that this listens on (docs/frame-stream.md).
///
/// A frame whose time stamp is not after the last one's is skipped with a warning and counted;
/// `read` throws when a second's worth of them come in a row. It throws, too, when a pipe's stream
/// is malformed or ends without its end record. On a socket that is a driver cut off: it is said,
/// and the next one that connects goes on; `read` throws when none does within
/// `StreamOptions::reconnect`. It gives nothing at the end record and when the stop flag is set.
class StreamSource : public RgbdSource {
 public:
  /// Of the camera file that the stream brought, where it did.
  virtual const std::optional<Camera>& own_camera() const = 0;
  /// To be called before the first `read`: depth outside the camera's range becomes 0. Throws
  /// `Error` when the stream's images have another size.
  virtual void use_camera(const Camera& camera) = 0;
};

/// Waits for the first driver and reads its header. Throws `Error` when the address cannot be
/// listened on, when what comes is no frame stream, and when the stop flag is set before it comes.
std::unique_ptr<StreamSource> open_stream(const StreamAddress& address,
                                          const StreamOptions& options = {});

}  // namespace dkp_slam
