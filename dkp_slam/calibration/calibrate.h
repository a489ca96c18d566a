#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "dkp_slam/calibration/adjustment.h"
#include "dkp_slam/calibration/known_length.h"
#include "dkp_slam/calibration/profile.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/rgbd_source.h"
#include "dkp_slam/system/config.h"

namespace dkp_slam {

/// A sequence that can be played several times, each time with another camera file.
struct CalibrationSequence {
  std::string name;
  std::function<std::unique_ptr<RgbdSource>(const Camera&)> open;
};

struct CalibrationOptions {
  /// Also find the bias of depth. Off: the less is sought, the surer it is.
  bool bias = false;
  bool focal = false;                ///< also find fx and fy
  bool principal_point = false;      ///< also find cx and cy
  bool distortion = false;           ///< also find k1, k2, p1, p2, k3
  bool depth_distortion = false;     ///< also find how depth is off across the image
  std::vector<KnownLength> lengths;  ///< in the first sequence; give the depth scale
  /// The map is made anew with what was found until that changes no more.
  int rounds = 3;
  /// Standard deviations above which something is not known: seconds, seconds, metres.
  double most_readout_sigma = 0.0015, most_delay_sigma = 0.003, most_bias_sigma = 0.01;
  /// Of the focal lengths, relative.
  double most_focal_sigma = 0.01;
  /// Of the principal point, in pixels of an image 640 wide.
  double most_principal_point_sigma = 1.5;
  /// Of each coefficient of the depth distortion, 1/metre.
  double most_depth_distortion_sigma = 0.002;
  WindowOptions windows;
  const std::atomic<bool>* stop = nullptr;  ///< ends it with an `Error` when set; may be null
};

/// A number of the camera file.
struct FoundValue {
  std::string key, unit;
  double before = 0.0, value = 0.0, sigma = 0.0;
  bool found = true;   ///< else it stays as it was, because the images do not tell it
  std::string reason;  ///< why it was not found
};

struct Calibration {
  Camera camera;
  std::vector<FoundValue> values;
  MeasuredNoise noise;
  int rounds = 0, frames = 0, windows = 0, sightings = 0, depths = 0;
  double image_speed = 0.0;             ///< root mean square of what is seen, pixels per second
  std::vector<ProfileBin> rows, rates;  ///< see profile.h, with what was found
  /// Of the last round's start, beside which `rates` are: seconds.
  double delay_before = 0.0;
};

/// Told how far it has come: frames done of all frames of all sequences of a round.
using CalibrationProgress = std::function<void(int round, std::size_t frame, std::size_t frames)>;

/// Finds what a camera file says wrongly, from the images alone. `config` holds what the camera
/// file says until now; its mode decides what is done about people. Throws `Error` with the reason
/// when the motion does not tell, and when nothing can be localised.
Calibration calibrate(const std::vector<CalibrationSequence>& sequences, const SlamConfig& config,
                      const CalibrationOptions& options, const CalibrationProgress& progress = {});

/// The camera file with what was found and how sure it is, as comments. `made_by`: one line.
std::string calibration_text(const Calibration& calibration, const std::string& made_by);

}  // namespace dkp_slam
