#include "dkp_slam/synth/noise/sensor_effects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/synth/noise/counter_random.h"

namespace dkp_slam {
namespace {

constexpr int curve_steps = 8192;

/// 8-bit sRGB of a linear signal in steps of 1 / 8192.
const std::array<std::uint8_t, curve_steps + 1>& srgb_curve() {
  static const auto curve = [] {
    std::array<std::uint8_t, curve_steps + 1> levels{};
    for (int i = 0; i <= curve_steps; ++i) {
      const double v = static_cast<double>(i) / curve_steps;
      const double c = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
      levels[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(255.0 * c));
    }
    return levels;
  }();
  return curve;
}

/// Mean grey of every eighth pixel, highlights cut off where the sensor at `gain` cuts them off.
double mean_signal(const cv::Mat& radiance, double gain) {
  constexpr int step = 8;
  double sum = 0.0;
  int count = 0;
  for (int y = step / 2; y < radiance.rows; y += step) {
    const auto* row = radiance.ptr<cv::Vec3f>(y);
    for (int x = step / 2; x < radiance.cols; x += step) {
      const double grey = (row[x][0] + row[x][1] + row[x][2]) / 3.0;
      sum += std::min(grey * gain, 1.0);
      ++count;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

}  // namespace

ColourSensor::ColourSensor(const SensorOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed), gain_(options.gain) {
  if (options.gain <= 0.0 || options.most_gain <= 0.0 || options.electrons <= 0.0 ||
      options.inertia < 0.0 || options.vignetting < 0.0 || options.vignetting > 1.0) {
    throw Error("colour sensor: gain and electrons must be above 0, vignetting 0 to 1");
  }
}

void ColourSensor::adapt(const cv::Mat& radiance, double time) {
  // The signal saturates, so that the gain which reaches the target is found step by step.
  double wanted = gain_;
  for (int i = 0; i < 4; ++i) {
    const double signal = mean_signal(radiance, wanted);
    wanted =
        std::clamp(wanted * options_.target / std::max(signal, 1e-6), 0.05, options_.most_gain);
  }
  double share = 1.0;  // the first frame: the camera has been running for a while
  if (last_time_ && options_.inertia > 0.0) {
    share = 1.0 - std::exp(-std::max(time - *last_time_, 0.0) / options_.inertia);
  }
  gain_ *= std::pow(wanted / gain_, share);
  last_time_ = time;
}

cv::Mat ColourSensor::expose(const cv::Mat& radiance, double time) {
  CV_Assert(radiance.type() == CV_32FC3);
  if (options_.automatic) adapt(radiance, time);
  const CounterRandom random(seed_ * 0x9E3779B97F4A7C15U + frames_++);
  const auto& curve = srgb_curve();
  const auto gain = static_cast<float>(gain_), dark = static_cast<float>(options_.vignetting);
  // Signal of one electron, and variances in units of signal.
  const auto electron = static_cast<float>(gain_ / options_.electrons);
  const float read = electron * static_cast<float>(options_.read_noise);
  const float half_width = 0.5F * static_cast<float>(radiance.cols);
  const float half_height = 0.5F * static_cast<float>(radiance.rows);
  const float corner2 = half_width * half_width + half_height * half_height;
  const bool noise = options_.noise;
  cv::Mat image(radiance.size(), CV_8UC3);
  cv::parallel_for_({0, radiance.rows}, [&](const cv::Range& range) {
    for (int y = range.start; y < range.end; ++y) {
      const auto* in = radiance.ptr<cv::Vec3f>(y);
      auto* out = image.ptr<cv::Vec3b>(y);
      const float dy = static_cast<float>(y) + 0.5F - half_height;
      auto counter = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(radiance.cols) * 3U;
      for (int x = 0; x < radiance.cols; ++x) {
        const float dx = static_cast<float>(x) + 0.5F - half_width;
        const float share = gain * (1.0F - dark * (dx * dx + dy * dy) / corner2);
        for (int c = 0; c < 3; ++c, ++counter) {
          float signal = share * in[x][c];
          if (noise) {
            signal += std::sqrt(electron * signal + read * read) * random.normal(counter);
          }
          const float step = std::clamp(signal, 0.0F, 1.0F) * curve_steps + 0.5F;
          out[x][c] = curve[static_cast<std::size_t>(step)];
        }
      }
    }
  });
  return image;
}

}  // namespace dkp_slam
