#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "dkp_slam/sensor/rgbd_source.h"
#include "dkp_slam/sensor/synthetic/motion.h"
#include "dkp_slam/sensor/synthetic/world.h"

namespace dkp_slam {

struct SyntheticOptions {
  SyntheticMotion motion = SyntheticMotion::xyz;
  int people = 2;
  std::size_t frames = 300;  ///< at the camera's frame rate
  std::uint64_t seed = 1;
  bool kinect_noise = true;  ///< depth noise, holes and shadows of a Kinect, mild image noise
  Camera camera = default_camera();

  /// 640 x 480 at 30 Hz, focal lengths of TUM's freiburg3, no lens distortion.
  static Camera default_camera();
};

/// Options of a named scenario: walking_xyz, walking_halfsphere, walking_static or static_xyz (the
/// same as walking_xyz without people). Throws `Error` on any other name.
SyntheticOptions synthetic_scenario(const std::string& name);

/// What is true of a frame of the synthetic world.
struct SyntheticTruth {
  Se3 world_from_camera;
  cv::Mat depth;  ///< CV_32FC1, metres, without noise
  cv::Mat mask;   ///< CV_8UC1, 255 on people
};

/// Frames of the synthetic world. Same options, same bytes.
class SyntheticSource : public RgbdSource {
 public:
  explicit SyntheticSource(const SyntheticOptions& options);

  std::string description() const override;
  std::optional<std::size_t> size() const override { return options_.frames; }
  std::optional<RgbdFrame> read() override;
  std::size_t skipped() const override { return 0; }

  /// Of the frame that `read` returned last.
  const SyntheticTruth& truth() const { return truth_; }
  /// Time stamp of a frame: whole microseconds, so that text files hold it exactly.
  double timestamp(std::size_t index) const;
  /// True pose at any time stamp.
  Se3 world_from_camera(double timestamp) const;

 private:
  SyntheticOptions options_;
  SyntheticWorld world_;
  SyntheticTruth truth_;
  std::size_t next_ = 0;
};

}  // namespace dkp_slam
