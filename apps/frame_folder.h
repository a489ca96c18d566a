#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "dkp_slam/export/images/ordered_work.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/rgbd_frame.h"
#include "dkp_slam/sensor/stream/channel.h"

namespace dkp_slam::apps {

/// Writes frames as a folder in the TUM benchmark's format: rgb/ and depth/ (PNG), mask/ where
/// frames have one, rgb.txt, depth.txt, associations.txt, camera.yaml. Several threads encode. A
/// frame is listed when its images are there, so that the folder is whole at any time, also when
/// the program is killed.
class FrameFolder {
 public:
  /// Makes the folder. Throws `Error` where it is not empty or cannot be written to.
  FrameFolder(std::filesystem::path out, const Camera& camera);

  /// Takes a frame. Where as many wait as memory is meant for (256 MB) it waits for room, or, if it
  /// is not to `wait`, returns false and leaves the frame out. Throws `Error` when a frame could
  /// not be written; those before it are in the folder then, whole.
  bool add(const RgbdFrame& frame, bool wait);
  /// Waits until everything is written. Throws as `add`.
  void finish();
  /// Frames listed so far.
  std::size_t written() const { return written_; }

 private:
  struct Names {
    std::string colour, depth, mask;  ///< without folder; mask may be empty
    std::string colour_stamp, depth_stamp;
  };
  void list(const Names& names);
  void drop(const Names& names) const;

  const std::filesystem::path out_;
  const double depth_scale_;
  const std::size_t most_waiting_;
  bool mask_folder_ = false;
  std::size_t written_ = 0;
  FileDescriptor rgb_, depth_, associations_;
  OrderedWork writing_;  // last: what it does needs the others
};

}  // namespace dkp_slam::apps
