#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/rgbd_source.h"
#include "dkp_slam/synth/noise/sensor_effects.h"
#include "dkp_slam/synth/render/renderer.h"
#include "dkp_slam/synth/scenario.h"

namespace dkp_slam {

struct SyntheticOptions {
  std::string scenario = "walking_xyz";
  /// As many arrive, at the camera's frame rate; 0: as many as the trajectory lasts.
  std::size_t frames = 600;
  std::size_t first_frame = 0;  ///< what happens before this frame is left out
  std::uint64_t seed = 1;
  /// Noise, quantisation, shadows, holes and range limits of a Kinect's depth, noise of its colour.
  /// Without: exact depth within the range limits, colour with exposure, vignetting and motion
  /// blur.
  bool kinect_noise = true;
  /// A readout time other than 0 makes it a rolling shutter. Depth images are wrong in the way that
  /// its `depth_correction` puts right.
  Camera camera = default_camera();
  /// Camera path in TUM format instead of the scenario's own (see `recorded_motion`); empty: none.
  std::filesystem::path trajectory;

  /// 640 x 480 at 30 Hz, focal lengths of TUM's freiburg3, no lens distortion, global shutter.
  static Camera default_camera();
};

/// Options of a named scenario (`scenario_names`) with as many frames as it should have. Throws
/// `Error` on any other name.
SyntheticOptions synthetic_scenario(const std::string& name);

/// An actor that is in view.
struct SyntheticObject {
  int instance = 0;        ///< its number in `SyntheticTruth::instance`, the same in every frame
  std::string class_name;  ///< of COCO's classes; empty: no detector knows it
  cv::Rect box;            ///< of all its pixels
  int pixels = 0;          ///< how many they are
};

/// What is true of a frame of the synthetic world.
struct SyntheticTruth {
  Se3 world_from_camera;  ///< at the frame's time stamp: the middle of its exposure and its rows
  cv::Mat depth;          ///< CV_32FC1, metres, without noise; 0 where nothing is
  cv::Mat instance;       ///< CV_8UC1, 0 on the place itself, else the actor's number from 1
  /// CV_8UC1, 255 on actors: people, and things that are moved at any time of the sequence, also
  /// while they rest.
  cv::Mat mask;
  std::vector<SyntheticObject> objects;  ///< by instance
};

/// Frames of the synthetic world. Same options, same bytes, on any number of threads.
class SyntheticSource : public RgbdSource {
 public:
  /// Throws `Error` on an unknown scenario, a camera that is none, a bad trajectory file, and one
  /// too short for that many frames.
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
  /// `duration`: of a recorded path, seconds.
  void plan_frames(std::optional<double> duration);
  /// What the depth sensor makes of a true depth image.
  cv::Mat sensed_depth(const cv::Mat& depth) const;

  SyntheticOptions options_;
  Scenario scenario_;
  DepthCorrector distorter_;
  std::vector<std::size_t> arriving_;         ///< which of the frames that the camera takes
  std::unique_ptr<const Renderer> renderer_;  ///< made for the first frame
  std::optional<ColourSensor> sensor_;        ///< its exposure follows the frames
  SyntheticTruth truth_;
  std::size_t next_ = 0;
};

}  // namespace dkp_slam
