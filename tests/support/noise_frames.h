#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/rgbd_source.h"

namespace dkp_slam::testing {

/// Of the noise frames below.
inline Camera noise_camera() {
  Camera camera;
  camera.name = "noise";
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 130.0;
  camera.cx = 79.5;
  camera.cy = 59.5;
  return camera;
}

/// Small pictures of noise, 10 ms apart: features on every one, none of them found again.
inline RgbdFrame noise_frame(int index) {
  RgbdFrame frame;
  frame.index = index;
  frame.timestamp = 100.0 + 0.01 * index;
  frame.colour.create(120, 160, CV_8UC3);
  cv::RNG(static_cast<std::uint64_t>(index) + 1).fill(frame.colour, cv::RNG::UNIFORM, 0, 256);
  frame.depth = cv::Mat::ones(120, 160, CV_32F);
  return frame;
}

/// Plays noise frames. `on_read` is called before each with the frame's index.
class NoiseSource : public RgbdSource {
 public:
  explicit NoiseSource(std::size_t frames, std::function<void(int)> on_read = {})
      : frames_(frames), on_read_(std::move(on_read)) {}
  std::string description() const override { return "noise"; }
  std::optional<std::size_t> size() const override { return frames_; }
  std::size_t skipped() const override { return 0; }
  std::optional<RgbdFrame> read() override {
    if (next_ == frames_) return std::nullopt;
    const int index = static_cast<int>(next_++);
    if (on_read_) on_read_(index);
    return noise_frame(index);
  }

 private:
  const std::size_t frames_;
  const std::function<void(int)> on_read_;
  std::size_t next_ = 0;
};

/// One detection a frame whose class is the frame's index. `on_detect` is called before.
class IndexDetector : public Detector {
 public:
  explicit IndexDetector(std::function<void(int)> on_detect = {})
      : on_detect_(std::move(on_detect)) {}
  std::string name() const override { return "index"; }
  std::vector<Detection> detect(const RgbdFrame& frame) override {
    if (on_detect_) on_detect_(frame.index);
    Detection d;
    d.class_id = frame.index;
    d.box = cv::Rect2f(10.0F, 10.0F, 20.0F, 20.0F);
    return {d};
  }

 private:
  const std::function<void(int)> on_detect_;
};

}  // namespace dkp_slam::testing
