#pragma once

#include <cstdint>
#include <optional>

#include <opencv2/core.hpp>

namespace dkp_slam {

struct SensorOptions {
  /// Exposure follows the image's brightness; otherwise `gain` holds for ever.
  bool automatic = true;
  double gain = 2.5;  ///< radiance to sensor signal, of which 1 is white: an office with its lights
  double target = 0.20;  ///< mean signal that it aims at: a grey of 124 in 8 bits
  /// Seconds in which it makes up for 63% of a change: webcams and the Kinect take about ten
  /// frames.
  double inertia = 0.3;
  double most_gain = 12.0;   ///< a dark room stays dark
  double vignetting = 0.22;  ///< share of the light that the corners lack
  double electrons = 10000;  ///< that a radiance of 1 sets free: shot noise, about 2 grey levels
  double read_noise = 12.0;  ///< electrons, standard deviation
  bool noise = true;
};

/// What a colour camera's sensor makes of the light (Healey and Kondepudy 1994, "Radiometric CCD
/// Camera Calibration and Noise Estimation", Eq. 1): exposure, vignetting, shot and read noise, the
/// sRGB curve. Frames must come in order of time; same input and seed, same bytes on any number of
/// threads.
class ColourSensor {
 public:
  ColourSensor(const SensorOptions& options, std::uint64_t seed);

  /// `radiance` is CV_32FC3, linear, BGR; `time` in seconds. CV_8UC3.
  cv::Mat expose(const cv::Mat& radiance, double time);
  /// Of the last frame.
  double gain() const { return gain_; }

 private:
  void adapt(const cv::Mat& radiance, double time);

  SensorOptions options_;
  std::uint64_t seed_;
  std::uint64_t frames_ = 0;
  double gain_;
  std::optional<double> last_time_;
};

}  // namespace dkp_slam
