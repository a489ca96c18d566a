#include "dkp_slam/sensor/bag/ros_image.h"

#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/png_encoder.h"

namespace dkp_slam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using Bytes = std::vector<std::uint8_t>;

/// Two pixels wide, one row, `step` bytes.
RosImage two_pixels(const std::string& encoding, const Bytes& bytes) {
  RosImage image;
  image.encoding = encoding;
  image.width = 2;
  image.height = 1;
  image.step = static_cast<std::uint32_t>(bytes.size());
  image.data = bytes;
  return image;
}

cv::Vec3b first_pixel(const std::string& encoding, const Bytes& bytes) {
  const cv::Mat image = colour_of(two_pixels(encoding, bytes));
  EXPECT_EQ(image.type(), CV_8UC3);
  EXPECT_EQ(image.size(), cv::Size(2, 1));
  return image.at<cv::Vec3b>(0, 0);
}

TEST(RosImage, ReadsColour) {
  const cv::Vec3b bgr(1, 2, 3);
  EXPECT_EQ(first_pixel("bgr8", {1, 2, 3, 4, 5, 6}), bgr);
  EXPECT_EQ(first_pixel("rgb8", {3, 2, 1, 6, 5, 4}), bgr);
  EXPECT_EQ(first_pixel("bgra8", {1, 2, 3, 255, 4, 5, 6, 255}), bgr);
  EXPECT_EQ(first_pixel("rgba8", {3, 2, 1, 255, 6, 5, 4, 255}), bgr);
  EXPECT_EQ(first_pixel("mono8", {7, 8}), cv::Vec3b(7, 7, 7));
  // Grey, of the narrow range of video: 16 is black, 235 white.
  EXPECT_EQ(first_pixel("yuv422", {128, 235, 128, 16}), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(first_pixel("YUYV", {235, 128, 16, 128}), cv::Vec3b(255, 255, 255));
}

TEST(RosImage, ReadsBayerPatterns) {
  // A red wall: only the filter's red pixels see something.
  const cv::Size size(8, 8);
  const struct {
    const char* encoding;
    cv::Point red;  // where it is in the two by two
  } patterns[] = {{"bayer_rggb8", {0, 0}},
                  {"bayer_bggr8", {1, 1}},
                  {"bayer_gbrg8", {0, 1}},
                  {"bayer_grbg8", {1, 0}}};
  for (const auto& [encoding, red] : patterns) {
    cv::Mat wall(size, CV_8UC1, cv::Scalar(0));
    for (int y = red.y; y < 8; y += 2) {
      for (int x = red.x; x < 8; x += 2) wall.at<std::uint8_t>(y, x) = 200;
    }
    RosImage image{encoding, 8, 8, 8, false, false, {wall.data, 64}};
    EXPECT_EQ(colour_of(image).at<cv::Vec3b>(4, 4), cv::Vec3b(0, 0, 200)) << encoding;
  }
}

TEST(RosImage, RowsMayBeLonger) {
  const Bytes bytes{1, 2, 99, 99, 3, 4, 99, 99};
  const RosImage image{"mono8", 2, 2, 4, false, false, bytes};
  EXPECT_EQ(colour_of(image).at<cv::Vec3b>(1, 0), cv::Vec3b(3, 3, 3));
}

TEST(RosImage, ReadsDepth) {
  // 1500 mm and unknown.
  const cv::Mat metres = depth_of(two_pixels("16UC1", {0xDC, 0x05, 0, 0}), 1000.0);
  ASSERT_EQ(metres.type(), CV_32FC1);
  EXPECT_FLOAT_EQ(metres.at<float>(0, 0), 1.5F);
  EXPECT_EQ(metres.at<float>(0, 1), 0.0F);
  RosImage big = two_pixels("mono16", {0x05, 0xDC, 0, 0});
  const Bytes bytes{0x05, 0xDC, 0, 0};
  big.data = bytes;
  big.big_endian = true;
  EXPECT_FLOAT_EQ(depth_of(big, 1000.0).at<float>(0, 0), 1.5F);

  const float values[] = {2.25F, std::numeric_limits<float>::quiet_NaN()};
  Bytes floats(sizeof(values));
  std::memcpy(floats.data(), values, sizeof(values));
  const cv::Mat of_floats = depth_of(two_pixels("32FC1", floats), 1000.0);
  EXPECT_EQ(of_floats.at<float>(0, 0), 2.25F);
  EXPECT_EQ(of_floats.at<float>(0, 1), 0.0F);
}

/// As in a message, which begins anywhere.
TEST(RosImage, ReadsDepthAtAnyAddress) {
  const Bytes bytes{0, 0, 0, 0, 0xDC, 0x05, 0xD0, 0x07, 0, 0, 0};
  for (const std::size_t shift : {0U, 1U, 2U, 3U}) {
    Bytes moved(bytes.begin() + 4 - static_cast<std::ptrdiff_t>(shift), bytes.end());
    RosImage image = two_pixels("16UC1", {0, 0, 0, 0});
    image.data = std::span<const std::uint8_t>(moved).subspan(shift, 4);
    EXPECT_FLOAT_EQ(depth_of(image, 1000.0).at<float>(0, 0), 1.5F);
    EXPECT_FLOAT_EQ(depth_of(image, 1000.0).at<float>(0, 1), 2.0F);
  }
}

TEST(RosImage, ReadsCompressedImages) {
  cv::Mat colour(16, 16, CV_8UC3, cv::Scalar(10, 20, 30));
  const Bytes png = encode_png(colour);
  RosImage image;
  image.compressed = true;
  image.encoding = "bgr8; png compressed bgr8";
  image.data = png;
  EXPECT_EQ(cv::norm(colour_of(image), colour, cv::NORM_INF), 0.0);

  const Bytes depth_png = encode_png(cv::Mat(2, 2, CV_16UC1, cv::Scalar(1500)));
  Bytes packed(12, 0);
  packed.insert(packed.end(), depth_png.begin(), depth_png.end());
  image.encoding = "16UC1; compressedDepth png";
  image.data = packed;
  EXPECT_FLOAT_EQ(depth_of(image, 1000.0).at<float>(1, 1), 1.5F);
  // Of float depth it holds a / metres + b.
  const float parameters[] = {3000.0F, -500.0F};
  std::memcpy(packed.data() + 4, parameters, sizeof(parameters));
  image.encoding = "32FC1; compressedDepth png";
  EXPECT_FLOAT_EQ(depth_of(image, 1000.0).at<float>(1, 1), 1.5F);
}

TEST(RosImage, SaysWhatIsWrong) {
  const Bytes few{1, 2, 3};
  EXPECT_THAT([&] { colour_of(two_pixels("bgr8", few)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("3 bytes"), HasSubstr("2 x 1"))));
  EXPECT_THAT([&] { colour_of(two_pixels("rgb16", few)); },
              ThrowsMessage<Error>(HasSubstr("\"rgb16\" is not known")));
  EXPECT_THAT([&] { depth_of(two_pixels("bgr8", few), 1000.0); },
              ThrowsMessage<Error>(HasSubstr("\"bgr8\" is not known for depth")));
  RosImage huge = two_pixels("mono8", few);
  huge.width = huge.step = 0xFFFFFFFF;
  huge.height = 2;
  EXPECT_THROW(colour_of(huge), Error);
  huge.height = 0;
  EXPECT_THROW(colour_of(huge), Error);
  RosImage damaged;
  damaged.compressed = true;
  damaged.encoding = "jpeg";
  damaged.data = few;
  EXPECT_THAT([&] { colour_of(damaged); }, ThrowsMessage<Error>(HasSubstr("damaged")));
  EXPECT_THAT([&] { depth_of(damaged, 1000.0); }, ThrowsMessage<Error>(HasSubstr("\"jpeg\"")));
  damaged.encoding = "16UC1; compressedDepth";
  EXPECT_THROW(depth_of(damaged, 1000.0), Error);
}

RosCameraInfo calibrated() {
  RosCameraInfo info;
  info.width = 640;
  info.height = 480;
  info.k = {525, 0, 319.5, 0, 526, 239.5, 0, 0, 1};
  info.p = {500, 0, 310, 0, 0, 501, 230, 0, 0, 0, 1, 0};
  info.distortion_model = "plumb_bob";
  info.d = {0.1, -0.2, 0.001, 0.002, 0.03};
  return info;
}

TEST(RosImage, RowsAreAsFarApartAsWholeNumbers) {
  const Bytes bytes(20);
  for (const char* encoding : {"16UC1", "32FC1"}) {
    const RosImage image{encoding, 2, 2, 9, false, false, bytes};
    EXPECT_THAT([&] { depth_of(image, 1000.0); }, ThrowsMessage<Error>(HasSubstr("9 bytes a row")));
  }
}

TEST(RosCameraInfo, MakesTheCamera) {
  const Camera raw = camera_of(calibrated(), false);
  EXPECT_EQ(raw.width, 640);
  EXPECT_EQ(raw.fy, 526);
  EXPECT_EQ(raw.cx, 319.5);
  EXPECT_EQ(raw.distortion.p1, 0.001);
  EXPECT_EQ(raw.distortion.k3, 0.03);
  EXPECT_EQ(raw.depth_scale, 1000.0);
  const Camera rectified = camera_of(calibrated(), true);
  EXPECT_EQ(rectified.fx, 500);
  EXPECT_EQ(rectified.cy, 230);
  EXPECT_TRUE(rectified.distortion.none());
}

TEST(RosCameraInfo, KnowsOneModelOfDistortion) {
  RosCameraInfo info = calibrated();
  info.distortion_model = "rational_polynomial";
  info.d = {0.1, -0.2, 0.001, 0.002, 0.03, 0, 0, 0};
  EXPECT_EQ(camera_of(info, false).distortion.k1, 0.1);
  info.d[5] = 0.5;
  EXPECT_THAT([&] { camera_of(info, false); },
              ThrowsMessage<Error>(HasSubstr("\"rational_polynomial\" with 8")));
  info.distortion_model = "equidistant";
  info.d = {0, 0, 0, 0};
  EXPECT_TRUE(camera_of(info, false).distortion.none());
  info.d = {0.1};
  EXPECT_THROW(camera_of(info, false), Error);
  EXPECT_THROW(camera_of(RosCameraInfo(), false), Error);  // never calibrated
}

}  // namespace
}  // namespace dkp_slam
