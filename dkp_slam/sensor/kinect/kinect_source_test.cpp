#include "dkp_slam/sensor/kinect/kinect_source.h"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/map_file/test_folder.h"

namespace dkp_slam {
namespace {

/// Waits for what is said of a device that is gone.
class Log : public spdlog::sinks::base_sink<std::mutex> {
 public:
  bool gone() const { return gone_; }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string_view text(message.payload.data(), message.payload.size());
    if (text.find("was unplugged") != std::string_view::npos) gone_ = true;
  }
  void flush_() override {}
  std::atomic<bool> gone_ = false;
};

/// fakenect plays the recording; this program finds it before libfreenect.
class KinectSourceTest : public testing::FolderTest {
 protected:
  /// As many frames, all at once; then the device is gone.
  void write_recording(int frames) const {
    const std::string colour(640 * 480 * 3, '\x40'), depth(640 * 480 * 2, '\x04');
    std::string index;
    for (int i = 0; i < frames; ++i) {
      for (const bool of_colour : {true, false}) {
        const std::string name =
            fmt::format("{}-1000.000000-{}.{}", of_colour ? 'r' : 'd',
                        1000 + i * 2'000'000 + (of_colour ? 0 : 1000), of_colour ? "ppm" : "pgm");
        std::ofstream(folder_ / name, std::ios::binary)
            << (of_colour ? "P6 640 480 255 \n" : "P5 640 480 65535 \n")
            << (of_colour ? colour : depth);
        index += name + '\n';
      }
    }
    std::ofstream(folder_ / "INDEX.txt") << index;
    ::setenv("FAKENECT_PATH", folder_.c_str(), 1);
  }
};

TEST_F(KinectSourceTest, WhatCameBeforeItWasStoppedIsRead) {
  constexpr int frames = 12;
  write_recording(frames);
  std::atomic<bool> stop = false;
  const auto log = std::make_shared<Log>();
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("", log));
  {
    KinectOptions options;
    options.stop = &stop;
    const auto source = open_kinect(options);
    while (!log->gone()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    stop = true;
    for (int i = 0; i < frames; ++i) {
      const auto frame = source->read();
      ASSERT_TRUE(frame.has_value()) << i;
      EXPECT_EQ(frame->index, i);
    }
    EXPECT_FALSE(source->read().has_value());
    EXPECT_EQ(source->lost(), 0U);
  }
  spdlog::set_default_logger(before);
}

}  // namespace
}  // namespace dkp_slam
