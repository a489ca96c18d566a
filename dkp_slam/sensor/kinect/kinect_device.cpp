#include "dkp_slam/sensor/kinect/kinect_device.h"

#include <sys/time.h>

#include <atomic>
#include <cstring>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <libfreenect.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

/// Of those that the library offers: asked for by name, what it does not have ends the program in
/// the stand-in library.
std::optional<freenect_frame_mode> colour_mode() {
  for (int i = 0; i < freenect_get_video_mode_count(); ++i) {
    const freenect_frame_mode mode = freenect_get_video_mode(i);
    if (mode.is_valid && mode.resolution == FREENECT_RESOLUTION_MEDIUM &&
        mode.video_format == FREENECT_VIDEO_RGB) {
      return mode;
    }
  }
  return std::nullopt;
}

std::optional<freenect_frame_mode> depth_mode() {
  std::optional<freenect_frame_mode> other;
  for (int i = 0; i < freenect_get_depth_mode_count(); ++i) {
    const freenect_frame_mode mode = freenect_get_depth_mode(i);
    if (!mode.is_valid || mode.resolution != FREENECT_RESOLUTION_MEDIUM) continue;
    if (mode.depth_format == FREENECT_DEPTH_REGISTERED) return mode;
    if (mode.bytes == KinectDevice::width * KinectDevice::height * 2) other = mode;
  }
  static std::atomic<bool> said = false;  // once, not whenever it is opened anew
  if (other && !said.exchange(true)) {
    spdlog::warn(
        "kinect: the library offers no registered depth (is it fakenect?); what comes is taken for "
        "that");
  }
  return other;
}

cv::Mat copied(const void* bytes, int type) {
  cv::Mat image(KinectDevice::height, KinectDevice::width, type);
  std::memcpy(image.data, bytes, image.total() * image.elemSize());
  return image;
}

}  // namespace

struct KinectDevice::Handles {
  Taken colour, depth;
  freenect_context* context = nullptr;
  freenect_device* device = nullptr;

  ~Handles() {
    if (device) {
      freenect_stop_video(device);
      freenect_stop_depth(device);
      freenect_close_device(device);
    }
    if (context) freenect_shutdown(context);
  }

  static void take_colour(freenect_device* device, void* bytes, std::uint32_t ticks) {
    of(device).colour(copied(bytes, CV_8UC3), ticks);
  }
  static void take_depth(freenect_device* device, void* bytes, std::uint32_t ticks) {
    of(device).depth(copied(bytes, CV_16UC1), ticks);
  }
  static Handles& of(freenect_device* device) {
    return *static_cast<Handles*>(freenect_get_user(device));
  }
};

KinectDevice::KinectDevice(int number, Taken colour, Taken depth)
    : handles_(std::make_unique<Handles>()) {
  Handles& h = *handles_;
  h.colour = std::move(colour);
  h.depth = std::move(depth);
  if (freenect_init(&h.context, nullptr) < 0) {
    h.context = nullptr;
    throw Error("kinect: USB cannot be used here; may this user do so, is there any?");
  }
  freenect_set_log_level(h.context, FREENECT_LOG_WARNING);
  freenect_set_log_callback(h.context, [](freenect_context*, freenect_loglevel, const char* text) {
    const std::string line(text);
    spdlog::debug("kinect: {}", line.substr(0, line.find_last_not_of('\n') + 1));
  });
  freenect_select_subdevices(h.context, FREENECT_DEVICE_CAMERA);
  const int there = freenect_num_devices(h.context);
  if (there <= number) {
    throw Error(there <= 0
                    ? std::string("kinect: none is plugged in; it needs its power supply, too")
                    : fmt::format("kinect:{}: {} are plugged in, counted from 0", number, there));
  }
  if (freenect_open_device(h.context, &h.device, number) < 0) {
    h.device = nullptr;
    throw Error(
        "kinect: cannot be opened; does another program use it, may this user (group plugdev)?");
  }
  freenect_set_user(h.device, &h);
  freenect_set_video_callback(h.device, &Handles::take_colour);
  freenect_set_depth_callback(h.device, &Handles::take_depth);
  const auto video = colour_mode(), range = depth_mode();
  if (!video || !range || freenect_set_video_mode(h.device, *video) < 0 ||
      freenect_set_depth_mode(h.device, *range) < 0 || freenect_start_depth(h.device) < 0 ||
      freenect_start_video(h.device) < 0) {
    throw Error("kinect: does not send colour and registered depth of 640 x 480; plug it in anew");
  }
}

KinectDevice::~KinectDevice() = default;

bool KinectDevice::process() {
  timeval wait{0, 100'000};
  return freenect_process_events_timeout(handles_->context, &wait) >= 0;
}

}  // namespace dkp_slam
