#include "dkp_slam/sensor/bag/bag_topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* image = "sensor_msgs/Image";
constexpr const char* compressed = "sensor_msgs/CompressedImage";
constexpr const char* info = "sensor_msgs/CameraInfo";

TEST(BagTopics, FindsTheTopicsOfATumBag) {
  const CameraTopics topics = choose_topics({{"/camera/depth/camera_info", info, 9},
                                             {"/camera/depth/image", image, 9},
                                             {"/camera/rgb/camera_info", info, 9},
                                             {"/camera/rgb/image_color", image, 9},
                                             {"/tf", "tf/tfMessage", 90}});
  EXPECT_EQ(topics.colour, "/camera/rgb/image_color");
  EXPECT_EQ(topics.depth, "/camera/depth/image");
  EXPECT_EQ(topics.colour_info, "/camera/rgb/camera_info");
  EXPECT_EQ(topics.depth_info, "/camera/depth/camera_info");
  EXPECT_EQ(topics.depth_unit, "");
}

TEST(BagTopics, FindsTheTopicsOfARealSenseRecording) {
  const CameraTopics topics =
      choose_topics({{"/device_0/sensor_0/Depth_0/image/data", image, 9},
                     {"/device_0/sensor_0/Depth_0/info/camera_info", info, 1},
                     {"/device_0/sensor_0/Depth_0/tf/0", "geometry_msgs/Transform", 1},
                     {"/device_0/sensor_0/Infrared_1/image/data", image, 9},
                     {"/device_0/sensor_0/option/Depth_Units/value", "std_msgs/Float32", 1},
                     {"/device_0/sensor_1/Color_0/image/data", image, 9},
                     {"/device_0/sensor_1/Color_0/info/camera_info", info, 1},
                     {"/device_0/sensor_1/Color_0/tf/0", "geometry_msgs/Transform", 1}});
  EXPECT_EQ(topics.colour, "/device_0/sensor_1/Color_0/image/data");
  EXPECT_EQ(topics.depth, "/device_0/sensor_0/Depth_0/image/data");
  EXPECT_EQ(topics.colour_info, "/device_0/sensor_1/Color_0/info/camera_info");
  EXPECT_EQ(topics.depth_info, "/device_0/sensor_0/Depth_0/info/camera_info");
  EXPECT_EQ(topics.colour_pose, "/device_0/sensor_1/Color_0/tf/0");
  EXPECT_EQ(topics.depth_pose, "/device_0/sensor_0/Depth_0/tf/0");
  EXPECT_EQ(topics.depth_unit, "/device_0/sensor_0/option/Depth_Units/value");
}

TEST(BagTopics, PrefersRegisteredDepthAndTakesCompressedImages) {
  const CameraTopics topics =
      choose_topics({{"/camera/color/image_raw/compressed", compressed, 9},
                     {"/camera/color/camera_info", info, 9},
                     {"/camera/depth/image_rect_raw", image, 9},
                     {"/camera/aligned_depth_to_color/image_raw", image, 9},
                     {"/camera/aligned_depth_to_color/image_raw/compressed", compressed, 9},
                     {"/camera/infra1/image_rect_raw", image, 9}});
  EXPECT_EQ(topics.colour, "/camera/color/image_raw/compressed");
  EXPECT_EQ(topics.depth, "/camera/aligned_depth_to_color/image_raw");
  EXPECT_EQ(topics.colour_info, "/camera/color/camera_info");
}

TEST(BagTopics, SaysWhatThereIsWhereOneIsMissing) {
  EXPECT_THAT(
      [] {
        choose_topics({{"/cam/image_raw", image, 9}, {"/imu", "sensor_msgs/Imu", 9}});
      },
      ThrowsMessage<Error>(
          AllOf(HasSubstr("no depth images"), HasSubstr("/cam/image_raw"), HasSubstr("--topics"))));
  EXPECT_THAT(
      [] {
        choose_topics({{"/imu", "sensor_msgs/Imu", 9}});
      },
      ThrowsMessage<Error>(HasSubstr("no images at all")));
  EXPECT_THAT(
      [] {
        choose_topics({{"/a", image, 9}, {"/b", image, 9}}, parse_topics("/a,/c"));
      },
      ThrowsMessage<Error>(AllOf(HasSubstr("no images in /c"), HasSubstr("/a, /b"))));
}

TEST(BagTopics, ReadsTheOption) {
  const CameraTopics two = parse_topics("/a,/b");
  EXPECT_EQ(two.colour, "/a");
  EXPECT_EQ(two.depth, "/b");
  EXPECT_EQ(parse_topics("/a,/b,/c").colour_info, "/c");
  for (const char* wrong : {"", "/a", "/a,", ",/b", "/a,/b,", "/a,/b,/c,/d"}) {
    EXPECT_THROW(parse_topics(wrong), Error) << wrong;
  }
}

}  // namespace
}  // namespace dkp_slam
