#include "dkp_slam/sensor/stream/stream_source.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <future>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/stream/test_driver.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::DriverConnection;
using dkp_slam::testing::end_of_stream;
using dkp_slam::testing::frame_of;
using dkp_slam::testing::header_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int width = 6, height = 4;

Camera small_camera() {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 5.0;
  camera.cx = 2.5;
  camera.cy = 1.5;
  camera.depth_scale = 1000.0;
  return camera;
}

stream::Header small_header() {
  stream::Header header;
  header.width = width;
  header.height = height;
  header.depth_scale = 1000.0;
  return header;
}

const cv::Mat blue(height, width, CV_8UC3, cv::Scalar(255, 0, 0));
const cv::Mat two_metres(height, width, CV_16UC1, cv::Scalar(2000));

std::string usual_header() { return header_of(small_header(), camera_text(small_camera())); }
std::string usual_frame(double stamp) { return frame_of(stamp, blue, two_metres); }

template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// A source that listens on a Unix socket, and drivers in threads of their own.
class StreamSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.channel.stop = &stop_;
    options_.reconnect = 10.0;
    fs::remove(path());
  }
  void TearDown() override {
    for (auto& driver : drivers_) driver.get();
    EXPECT_FALSE(fs::exists(path())) << "the socket was left behind";
  }

  static std::string path() {
    return ::testing::TempDir() + ::testing::UnitTest::GetInstance()->current_test_info()->name();
  }
  static std::string address() { return "unix:" + path(); }

  /// Connects, sends each of these, and goes.
  void drive(std::vector<std::string> parts) {
    drivers_.push_back(std::async(std::launch::async, [parts = std::move(parts)] {
      DriverConnection connection(address());
      try {
        for (const std::string& part : parts) connection.send(part);
      } catch (const Error&) {  // the source has seen enough and is gone
      }
    }));
  }
  std::unique_ptr<StreamSource> open() {
    auto source = open_stream(StreamAddress::parse(address()), options_);
    if (source->own_camera()) source->use_camera(*source->own_camera());
    return source;
  }
  /// Stops what waits, after a while.
  void stop_soon() {
    drivers_.push_back(std::async(std::launch::async, [this] {
      std::this_thread::sleep_for(std::chrono::milliseconds(150));
      stop_ = true;
    }));
  }

  std::atomic<bool> stop_{false};
  StreamOptions options_;
  std::vector<std::future<void>> drivers_;
};

TEST_F(StreamSourceTest, GivesFramesUntilTheEnd) {
  drive({usual_header(), frame_of(1.5, blue, two_metres, {}, -0.01), usual_frame(1.75),
         end_of_stream()});
  const auto source = open();
  ASSERT_TRUE(source->own_camera());
  EXPECT_EQ(source->own_camera()->fx, 5.0);
  EXPECT_EQ(source->size(), std::nullopt);
  const auto first = source->read();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->index, 0);
  EXPECT_EQ(first->timestamp, 1.5);
  EXPECT_EQ(first->depth_delay, -0.01);
  EXPECT_EQ(cv::norm(first->colour, blue, cv::NORM_INF), 0.0);
  EXPECT_EQ(first->depth.type(), CV_32FC1);
  EXPECT_EQ(first->depth.at<float>(3, 5), 2.0F);
  EXPECT_TRUE(first->mask.empty());
  const auto second = source->read();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->index, 1);
  EXPECT_NE(second->colour.data, first->colour.data);
  EXPECT_FALSE(source->read());
  EXPECT_FALSE(source->read());
  EXPECT_EQ(source->skipped(), 0U);
}

TEST_F(StreamSourceTest, ReadsEveryFormat) {
  stream::Header header = small_header();
  header.colour = stream::ColourFormat::rgb8;
  header.depth = stream::DepthFormat::f32;
  cv::Mat metres(height, width, CV_32FC1, cv::Scalar(3.5));
  metres.at<float>(0, 0) = std::numeric_limits<float>::quiet_NaN();
  metres.at<float>(0, 1) = -1.0F;
  metres.at<float>(0, 2) = 0.1F;    // nearer than the camera sees
  metres.at<float>(0, 3) = 100.0F;  // farther
  metres.at<float>(0, 4) = std::numeric_limits<float>::infinity();
  drive({header_of(header, camera_text(small_camera())), frame_of(1.0, blue, metres),
         end_of_stream()});
  const auto frame = open()->read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->colour.at<cv::Vec3b>(1, 1), cv::Vec3b(0, 0, 255));
  for (int u = 0; u < 5; ++u) EXPECT_EQ(frame->depth.at<float>(0, u), 0.0F) << u;
  EXPECT_EQ(frame->depth.at<float>(0, 5), 3.5F);

  header = small_header();
  header.colour = stream::ColourFormat::grey8;
  const cv::Mat grey(height, width, CV_8UC1, cv::Scalar(77));
  drive({header_of(header, camera_text(small_camera())), frame_of(1.0, grey, two_metres),
         end_of_stream()});
  const auto plain = open()->read();
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->colour.at<cv::Vec3b>(2, 3), cv::Vec3b(77, 77, 77));
}

TEST_F(StreamSourceTest, GivesMasksWhereTheyAreWanted) {
  const cv::Mat mask(height, width, CV_8UC1, cv::Scalar(9));
  const std::vector<std::string> parts = {usual_header(), frame_of(1.0, blue, two_metres, mask),
                                          usual_frame(2.0), end_of_stream()};
  drive(parts);
  {
    const auto source = open();
    EXPECT_TRUE(source->read()->mask.empty());
  }
  options_.masks = true;
  drive(parts);
  const auto source = open();
  EXPECT_EQ(source->read()->mask.at<uchar>(0, 0), 9);
  EXPECT_TRUE(source->read()->mask.empty());
  EXPECT_EQ(source->without_mask(), 1U);
}

TEST_F(StreamSourceTest, StampsThatGoBackAreSkippedAndCounted) {
  drive({usual_header(), usual_frame(5.0), usual_frame(5.0), usual_frame(4.0), usual_frame(6.0),
         end_of_stream()});
  const auto source = open();
  EXPECT_EQ(source->read()->timestamp, 5.0);
  const auto next = source->read();
  ASSERT_TRUE(next);
  EXPECT_EQ(next->timestamp, 6.0);
  EXPECT_EQ(next->index, 3);
  EXPECT_EQ(source->skipped(), 2U);
}

TEST_F(StreamSourceTest, AClockThatStaysBackEndsTheStream) {
  std::vector<std::string> parts = {usual_header(), usual_frame(100.0)};
  for (int i = 0; i < 30; ++i) parts.push_back(usual_frame(i));
  drive(parts);
  const auto source = open();
  EXPECT_TRUE(source->read());
  EXPECT_THAT(message_of([&] { source->read(); }),
              AllOf(HasSubstr("29.000000 is not after the last frame's 100.000000"),
                    HasSubstr("the same clock")));
}

TEST_F(StreamSourceTest, GoesOnWithADriverThatComesBack) {
  const std::string half = usual_frame(3.0).substr(0, 50);
  drive({usual_header(), usual_frame(1.0), usual_frame(2.0), half});
  const auto source = open();
  EXPECT_EQ(source->read()->timestamp, 1.0);
  EXPECT_EQ(source->read()->timestamp, 2.0);
  drive({usual_header(), usual_frame(3.0), end_of_stream()});
  const auto third = source->read();
  ASSERT_TRUE(third);
  EXPECT_EQ(third->timestamp, 3.0);
  EXPECT_EQ(third->index, 2);
  EXPECT_FALSE(source->read());
}

TEST_F(StreamSourceTest, ADriverThatWritesNonsenseIsSentAwayAndAnotherGoesOn) {
  drive({usual_header(), usual_frame(1.0), "nonsense"});
  const auto source = open();
  EXPECT_EQ(source->read()->timestamp, 1.0);
  drivers_.push_back(std::async(std::launch::async, [] {
    { DriverConnection(address()).send(std::string(40, 'x')); }
    stream::Header other = small_header();
    other.width = 2 * width;
    { DriverConnection(address()).send(header_of(other, "")); }
    DriverConnection(address()).send(usual_header() + usual_frame(2.0) + end_of_stream());
  }));
  EXPECT_EQ(source->read()->timestamp, 2.0);
  EXPECT_FALSE(source->read());
}

TEST_F(StreamSourceTest, EndsWhereNobodyComesBack) {
  options_.reconnect = 0.1;
  drive({usual_header(), usual_frame(1.0)});
  const auto source = open();
  EXPECT_TRUE(source->read());
  EXPECT_THAT(message_of([&] { source->read(); }),
              AllOf(HasSubstr("cut off after 1 frames, without the end record"),
                    HasSubstr("no driver came back within 0.1 s (--reconnect)")));
}

TEST_F(StreamSourceTest, ASilentDriverMakesRoomForAnother) {
  options_.channel.silence = 0.1;
  std::unique_ptr<DriverConnection> silent;
  std::promise<void> sent;
  drivers_.push_back(std::async(std::launch::async, [&] {
    silent = std::make_unique<DriverConnection>(address());
    silent->send(usual_header() + usual_frame(1.0));
    sent.set_value();
  }));
  const auto source = open();
  EXPECT_EQ(source->read()->timestamp, 1.0);
  sent.get_future().wait();
  drive({usual_header(), usual_frame(2.0), end_of_stream()});
  EXPECT_EQ(source->read()->timestamp, 2.0);
  EXPECT_FALSE(source->read());
}

TEST_F(StreamSourceTest, TheStopFlagEndsEveryWait) {
  stop_soon();
  EXPECT_THAT(message_of([&] { open(); }), HasSubstr("interrupted before a stream came"));
  stop_ = false;
  std::unique_ptr<DriverConnection> silent;
  drivers_.push_back(std::async(std::launch::async, [&] {
    silent = std::make_unique<DriverConnection>(address());
    silent->send(usual_header() + usual_frame(1.0).substr(0, 30));
  }));
  const auto source = open();
  stop_soon();
  EXPECT_FALSE(source->read());
  drivers_[1].wait();
}

TEST_F(StreamSourceTest, RefusesAFirstDriverThatIsNone) {
  drive({std::string(40, 'x')});
  EXPECT_THAT(message_of([&] { open(); }), AllOf(HasSubstr(path()), HasSubstr("no frame stream")));
  drive({usual_header().substr(0, 20)});
  EXPECT_THAT(message_of([&] { open(); }),
              HasSubstr("cut off in the middle of the header (20 of 40 bytes came)"));
  drive({header_of(small_header(), "width: many\n")});
  EXPECT_THAT(message_of([&] { open(); }), HasSubstr("camera file: height is missing"));
  drive({usual_header()});
  Camera other = small_camera();
  other.width = 640;
  EXPECT_THAT(message_of([&] { open()->use_camera(other); }),
              HasSubstr("6 x 4 pixels but the camera file says 640 x 4"));
}

TEST_F(StreamSourceTest, AStampThatIsNoNumberEndsTheDriver) {
  options_.reconnect = 0.0;
  drive({usual_header(), usual_frame(std::nan(""))});
  const auto source = open();
  EXPECT_THAT(message_of([&] { source->read(); }), HasSubstr("is no number"));
}

TEST_F(StreamSourceTest, WorksThroughTcpOnAFreePort) {
  const ChannelOptions options;
  const auto input = ByteInput::open(StreamAddress::parse("tcp:0"), options);
  EXPECT_THAT(input->name(), ::testing::MatchesRegex("tcp:127\\.0\\.0\\.1:[1-9][0-9]*"));
  auto driver = std::async(std::launch::async,
                           [name = input->name()] { DriverConnection(name).send("twelve bytes"); });
  ASSERT_TRUE(input->next_peer(10.0));
  std::string bytes(20, '\0');
  EXPECT_EQ(input->read(bytes), 12U);
  EXPECT_EQ(bytes.substr(0, 12), "twelve bytes");
}

TEST_F(StreamSourceTest, ListensWhereAKilledProgramLeftItsSocketAndNowhereElse) {
  const ChannelOptions options;
  const auto listen = [&] { return ByteInput::open(StreamAddress::parse(address()), options); };
  const std::string left = path() + "_left";
  {
    const auto first = listen();
    EXPECT_THAT(message_of([&] { listen(); }), HasSubstr("another program listens there"));
    fs::create_hard_link(path(), left);
  }
  fs::rename(left, path());
  EXPECT_NO_THROW(listen());
  std::ofstream(path()) << "a file of the user's";
  EXPECT_THAT(message_of([&] { listen(); }), HasSubstr("is no socket"));
  EXPECT_TRUE(fs::is_regular_file(path()));
  fs::remove(path());
}

TEST_F(StreamSourceTest, RefusesWhatIsNoAddress) {
  EXPECT_FALSE(StreamAddress::looks_like("folder/unix:x"));
  for (const char* text : {"unix:", "tcp:", "tcp:x", "tcp:65536", "tcp::80", "tcp:host:", "-x"}) {
    EXPECT_THAT(message_of([&] { StreamAddress::parse(text); }), HasSubstr("is no address"))
        << text;
  }
  EXPECT_THAT(message_of([&] { StreamAddress::parse("unix:" + std::string(200, 'x')); }),
              HasSubstr("too long for a socket"));
  EXPECT_EQ(StreamAddress::parse("tcp:[::1]:80").host, "::1");
  EXPECT_EQ(StreamAddress::parse("tcp:80").host, "127.0.0.1");
}

}  // namespace
}  // namespace dkp_slam
