#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dkp_slam/export/images/ordered_work.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/synth/source.h"

namespace dkp_slam {

/// Writes synthetic frames as a folder in the TUM benchmark's format with all that is true of them:
/// rgb/, depth/, mask/ and instances/ (PNG), rgb.txt, depth.txt, associations.txt, groundtruth.txt,
/// detections.txt, camera.yaml. Images are written by several threads, several frames at once.
class SequenceWriter {
 public:
  /// Into `out`, which must be there; writes camera.yaml and makes the image folders.
  SequenceWriter(std::filesystem::path out, const Camera& camera);

  /// Everything this writes, folders and files, as names in `out`.
  static const std::vector<std::string>& names();

  /// Throws `Error` when an image, of this frame or one before, cannot be written; the frame's
  /// images are gone then, with those of all after it.
  void add(const RgbdFrame& frame, const SyntheticTruth& truth);
  /// Waits for the images and writes the lists: of the frames that have all their images, and the
  /// true path at 100 Hz and at every frame's moment, from the first frame to the last.
  void finish(const SyntheticSource& source);

 private:
  /// A frame whose images are written.
  struct Listed {
    double timestamp = 0.0;
    std::string stamp;
    std::string detections;  ///< its lines
  };

  void list(const Listed& frame);
  void drop(const std::string& stamp) const;

  std::filesystem::path out_;
  double depth_scale_;
  std::string rgb_, depth_, associations_, detections_;
  std::vector<double> stamps_;
  OrderedWork writing_;  // last: what it does needs the others
};

}  // namespace dkp_slam
