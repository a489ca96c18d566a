#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// A Kinect that is open and sends images. All of one thread.
class KinectDevice {
 public:
  /// Told of every image: CV_8UC3, RGB, or CV_16UC1, millimetres, registered to colour, 0 unknown;
  /// with the device's counter.
  using Taken = std::function<void(cv::Mat image, std::uint32_t ticks)>;

  static constexpr int width = 640, height = 480;

  /// Throws `Error` where there is no such Kinect or it cannot be opened.
  KinectDevice(int number, Taken colour, Taken depth);
  ~KinectDevice();
  KinectDevice(const KinectDevice&) = delete;
  KinectDevice& operator=(const KinectDevice&) = delete;

  /// Waits for images, a tenth of a second at most. False when the device is gone.
  bool process();

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace dkp_slam
