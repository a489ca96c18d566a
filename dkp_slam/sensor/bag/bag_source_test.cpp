#include "dkp_slam/sensor/bag/bag_source.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map_file/test_folder.h"
#include "dkp_slam/sensor/bag/test_bag.h"
#include "tests/support/file_text.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::PlainBag;
using dkp_slam::testing::TestBag;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class BagSourceTest : public testing::FolderTest {
 protected:
  std::string file() const { return folder_ / "test.bag"; }
  std::unique_ptr<BagSource> opened() const {
    auto bag = open_bag(file());
    bag->use_camera(bag->own_camera().value());
    return bag;
  }
};

TEST_F(BagSourceTest, GivesPixelsAndStampsAsTheyWereRecorded) {
  const cv::Mat colour = TestBag::pattern(), depth(4, 6, CV_16UC1, cv::Scalar(1500));
  {
    TestBag bag(file());
    bag.info("/camera/rgb/camera_info", 1.0, {6, 4}, 500.0);
    for (int i = 0; i < 3; ++i) {
      bag.image("/camera/rgb/image_color", 1.0 + i / 10.0, colour + cv::Scalar::all(i), "bgr8");
      bag.image("/camera/depth/image", 1.004 + i / 10.0, depth, "16UC1");
    }
  }
  const auto bag = opened();
  EXPECT_EQ(bag->own_camera()->fx, 500.0);
  EXPECT_EQ(bag->own_camera()->frame_rate, 10.0);
  for (int i = 0; i < 3; ++i) {
    const auto frame = bag->read();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
    EXPECT_DOUBLE_EQ(frame->timestamp, 1.0 + i / 10.0);
    EXPECT_NEAR(frame->depth_delay, 0.004, 1e-6);
    EXPECT_EQ(cv::norm(frame->colour, colour + cv::Scalar::all(i), cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(frame->depth, cv::Mat(4, 6, CV_32FC1, cv::Scalar(1.5F)), cv::NORM_INF), 0.0);
  }
  EXPECT_FALSE(bag->read());
  EXPECT_EQ(bag->skipped(), 0U);
}

TEST_F(BagSourceTest, ReadsOtherEncodings) {
  const cv::Mat colour = TestBag::pattern();
  cv::Mat rgb = TestBag::pattern();
  for (int y = 0; y < rgb.rows; ++y) {
    for (int x = 0; x < rgb.cols; ++x)
      std::swap(rgb.at<cv::Vec3b>(y, x)[0], rgb.at<cv::Vec3b>(y, x)[2]);
  }
  {
    TestBag bag(file());
    bag.info("/cam/color/camera_info", 1.0, {6, 4}, 500.0);
    bag.image("/cam/color/image_raw", 1.0, rgb, "rgb8");
    bag.image("/cam/depth_registered/image", 1.0, cv::Mat(4, 6, CV_32FC1, cv::Scalar(2.5F)),
              "32FC1");
  }
  const auto frame = opened()->read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(cv::norm(frame->colour, colour, cv::NORM_INF), 0.0);
  EXPECT_EQ(frame->depth.at<float>(2, 3), 2.5F);
}

TEST_F(BagSourceTest, RegistersTheDepthOfARealSenseRecording) {
  const std::string depth = "/device_0/sensor_0/Depth_0", colour = "/device_0/sensor_1/Color_0";
  {
    TestBag bag(file());
    bag.info(depth + "/info/camera_info", 0.0, {6, 4}, 100.0);
    bag.info(colour + "/info/camera_info", 0.0, {6, 4}, 100.0, 0.25);
    bag.transform(depth + "/tf/0", {});
    // Points of the device are 4 cm further to the left for the colour camera.
    bag.transform(colour + "/tf/0", {{1, 0, 0, 0}, {-0.04, 0, 0}});
    bag.number("/device_0/sensor_0/option/Depth_Units/value", 0.0005F);
    bag.image(colour + "/image/data", 5.0, TestBag::pattern(), "rgb8");
    cv::Mat units(4, 6, CV_16UC1, cv::Scalar(0));
    units.at<std::uint16_t>(1, 4) = 4000;  // 2 m
    bag.image(depth + "/image/data", 5.0, units, "mono16");
  }
  const auto frame = opened()->read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(cv::countNonZero(frame->depth), 1);
  EXPECT_FLOAT_EQ(frame->depth.at<float>(1, 2), 2.0F);
}

TEST_F(BagSourceTest, DepthOutsideTheCamerasRangeIsUnknown) {
  {
    TestBag bag(file());
    bag.info("/rgb/camera_info", 1.0, {6, 4}, 500.0);
    bag.image("/rgb/image", 1.0, TestBag::pattern(), "bgr8");
    cv::Mat depth(4, 6, CV_16UC1, cv::Scalar(1500));
    depth.at<std::uint16_t>(0, 0) = 20000;
    bag.image("/depth/image", 1.0, depth, "16UC1");
  }
  const auto bag = open_bag(file());
  Camera camera = *bag->own_camera();
  camera.depth_correction.delay = 0.01;
  camera.depth_correction.bias = 0.25;
  bag->use_camera(camera);
  const auto frame = bag->read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth.at<float>(0, 0), 0.0F);
  EXPECT_EQ(frame->depth.at<float>(0, 1), 1.75F);
  EXPECT_NEAR(frame->depth_delay, 0.01, 1e-9);
}

TEST_F(BagSourceTest, SkipsAnImageThatCannotBeRead) {
  {
    TestBag bag(file());
    bag.info("/rgb/camera_info", 1.0, {6, 4}, 500.0);
    for (int i = 0; i < 3; ++i) {
      bag.image("/rgb/image", 1.0 + i, TestBag::pattern(), i == 1 ? "strange" : "bgr8");
      bag.image("/depth/image", 1.0 + i, cv::Mat(4, 6, CV_16UC1, cv::Scalar(1500)), "16UC1");
    }
  }
  const auto bag = opened();
  EXPECT_EQ(bag->read()->index, 0);
  EXPECT_EQ(bag->read()->index, 2);
  EXPECT_FALSE(bag->read());
  EXPECT_EQ(bag->skipped(), 1U);
}

TEST_F(BagSourceTest, SaysWhatIsWrongWithABag) {
  const auto opening = [this] { open_bag(file()); };
  EXPECT_THAT(opening,
              ThrowsMessage<Error>(AllOf(HasSubstr("test.bag"), HasSubstr("no such file"))));
  std::ofstream(file()) << "something else";
  EXPECT_THAT(opening, ThrowsMessage<Error>(HasSubstr("test.bag: is no ROS 1 bag")));
  TestBag(file()).image("/rgb/image", 1.0, TestBag::pattern(), "bgr8");
  EXPECT_THAT(opening,
              ThrowsMessage<Error>(AllOf(HasSubstr("no depth images"), HasSubstr("/rgb/image"))));
  const cv::Mat depth(4, 6, CV_16UC1, cv::Scalar(1500));
  {
    TestBag bag(file());
    bag.image("/rgb/image", 1.0, TestBag::pattern(), "bgr8");
    bag.image("/depth/image", 2.0, depth, "16UC1");
  }
  EXPECT_THAT(opening,
              ThrowsMessage<Error>(HasSubstr("none of 1 colour images has a depth image")));
  {
    TestBag bag(file());
    bag.image("/rgb/image", 1.0, TestBag::pattern(), "bgr8");
    bag.image("/depth/image", 1.0, depth, "strange");
  }
  EXPECT_THAT(opening, ThrowsMessage<Error>(AllOf(HasSubstr("/depth/image"),
                                                  HasSubstr("\"strange\" is not known"))));
  {
    TestBag bag(file());
    bag.image("/rgb/image", 1.0, TestBag::pattern(), "bgr8");
    bag.image("/depth/image", 1.0, depth.rowRange(0, 2), "16UC1");
  }
  Camera camera;
  camera.fx = camera.fy = 500.0;
  camera.width = 6;
  camera.height = 4;
  EXPECT_FALSE(open_bag(file())->own_camera());
  EXPECT_THAT([&] { open_bag(file())->use_camera(camera); },
              ThrowsMessage<Error>(HasSubstr("must be registered")));
  camera.width = 7;
  EXPECT_THAT([&] { open_bag(file())->use_camera(camera); },
              ThrowsMessage<Error>(AllOf(HasSubstr("6 x 4"), HasSubstr("7 x 4"))));
}

TEST_F(BagSourceTest, ABagThatWasCutOffIsOneLine) {
  {
    TestBag bag(file());
    for (int i = 0; i < 50; ++i) {
      bag.image("/rgb/image", 1.0 + i, TestBag::pattern(), "bgr8");
      bag.image("/depth/image", 1.0 + i, cv::Mat(4, 6, CV_16UC1, cv::Scalar(1500)), "16UC1");
    }
  }
  const auto whole = fs::file_size(file());
  for (const auto size : {whole - 10, whole / 2, std::uintmax_t{5000}, std::uintmax_t{20}}) {
    fs::resize_file(file(), size);
    EXPECT_THAT([this] { open_bag(file()); },
                ThrowsMessage<Error>(AllOf(HasSubstr("test.bag"), HasSubstr("cut off"))))
        << size;
  }
}

TEST_F(BagSourceTest, AFieldThatGoesOnBehindItsHeaderIsDamage) {
  {
    TestBag bag(file());
    bag.image("/rgb/image", 1.0, TestBag::pattern(), "bgr8");
    bag.image("/depth/image", 1.0, cv::Mat(4, 6, CV_16UC1, cv::Scalar(1500)), "16UC1");
  }
  const std::string whole = content(file());
  // Of the bag, of a connection and of what it holds; no more than rosbag itself lets pass.
  for (const std::string field : {"op=", "index_pos=", "conn=", "topic=", "type=", "md5sum="}) {
    std::string bytes = whole;
    constexpr std::uint32_t length = 900'000;
    bytes.replace(bytes.find(field) - sizeof(length), sizeof(length),
                  reinterpret_cast<const char*>(&length), sizeof(length));
    std::ofstream(file(), std::ios::binary | std::ios::trunc) << bytes;
    EXPECT_THAT([this] { open_bag(file()); },
                ThrowsMessage<Error>(AllOf(HasSubstr("damaged"), HasSubstr("is not whole"))))
        << field;
  }
}

TEST_F(BagSourceTest, CompressedBagsAreReadAsTheyAre) {
  const cv::Mat depth(480, 640, CV_16UC1, cv::Scalar(1500));
  cv::Mat colour(480, 640, CV_8UC3);
  for (const auto compression : {rosbag::compression::LZ4, rosbag::compression::BZ2}) {
    {
      TestBag bag(file(), compression);
      bag.info("/rgb/camera_info", 1.0, colour.size(), 500.0);
      // More than a chunk of 768 kB each.
      for (int i = 0; i < 4; ++i) {
        cv::theRNG().state = static_cast<std::uint64_t>(i + 1);
        cv::randu(colour, 0, 256);
        bag.image("/rgb/image", 1.0 + i, colour, "bgr8");
        bag.image("/depth/image", 1.0 + i, depth, "16UC1");
      }
    }
    const auto bag = opened();
    for (int i = 0; i < 4; ++i) {
      const auto frame = bag->read();
      ASSERT_TRUE(frame) << i;
      cv::theRNG().state = static_cast<std::uint64_t>(i + 1);
      cv::randu(colour, 0, 256);
      EXPECT_EQ(cv::norm(frame->colour, colour, cv::NORM_INF), 0.0);
    }
    EXPECT_FALSE(bag->read());
  }
}

TEST_F(BagSourceTest, WhatACompressedChunkHoldsIsLookedAtBeforeItIsRead) {
  {
    TestBag bag(file());
    bag.info("/rgb/camera_info", 1.0, {6, 4}, 500.0);
    bag.image("/rgb/image", 1.0, TestBag::pattern(), "bgr8");
    bag.image("/depth/image", 1.0, cv::Mat(4, 6, CV_16UC1, cv::Scalar(1500)), "16UC1");
  }
  const PlainBag good(content(file()));
  const auto write = [this](const std::string& bytes) {
    std::ofstream(file(), std::ios::binary | std::ios::trunc) << bytes;
  };
  write(good.packed());
  EXPECT_TRUE(opened()->read());

  const auto refused = [&](const std::string& bytes) {
    write(bytes);
    EXPECT_THAT([this] { open_bag(file()); },
                ThrowsMessage<Error>(AllOf(HasSubstr("damaged"), HasSubstr("is not whole"))));
  };
  constexpr std::uint32_t length = 900'000;
  const std::string long_field(reinterpret_cast<const char*>(&length), sizeof(length));
  for (const std::string field : {"conn=", "topic=", "type=", "time="}) {
    PlainBag bag = good;
    bag.chunk.replace(bag.chunk.find(field) - long_field.size(), long_field.size(), long_field);
    refused(bag.packed());
  }
  // The last message's data, 24 pixels of two bytes and what comes before them, end elsewhere.
  PlainBag cut = good;
  cut.chunk.resize(cut.chunk.size() - 1);
  refused(cut.packed());
  refused(cut.packed(1));
  // An index that names a place within a record.
  PlainBag astray = good;
  // Behind its header and, of the first entry, the time.
  const std::size_t place = 4 + static_cast<unsigned char>(astray.index[0]) + 4 + 8;
  astray.index[place] = static_cast<char>(astray.index[place] + 1);
  refused(astray.packed());
}

TEST_F(BagSourceTest, PlacesThatAreNoRecordsAreDamage) {
  {
    TestBag bag(file());
    bag.image("/rgb/image", 1.0, TestBag::pattern(), "bgr8");
    bag.image("/depth/image", 1.0, cv::Mat(4, 6, CV_16UC1, cv::Scalar(1500)), "16UC1");
  }
  const std::string whole = content(file());
  for (const std::string field : {"index_pos=", "chunk_pos="}) {
    std::string bytes = whole;
    char& lowest = bytes[bytes.find(field) + field.size()];
    lowest = static_cast<char>(lowest + 1);
    std::ofstream(file(), std::ios::binary | std::ios::trunc) << bytes;
    EXPECT_THAT([this] { open_bag(file()); },
                ThrowsMessage<Error>(AllOf(HasSubstr("damaged"), HasSubstr("is not whole"))))
        << field;
  }
}

TEST_F(BagSourceTest, AnArrayThatIsLongerThanAnyImageIsNotMade) {
  {
    TestBag bag(file());
    bag.info("/rgb/camera_info", 1.0, {6, 4}, 500.0);
    bag.image("/rgb/image", 1.0, TestBag::pattern(), "bgr8");
    bag.image("/depth/image", 1.0, cv::Mat(4, 6, CV_16UC1, cv::Scalar(1500)), "16UC1");
  }
  std::string bytes = content(file());
  // With its length, as the message has it; how many distortion coefficients there are follows.
  const std::string model("\x09\0\0\0plumb_bob", 13);
  ASSERT_NE(bytes.find(model), bytes.npos);
  constexpr std::uint32_t gigabytes = 800'000'000;
  bytes.replace(bytes.find(model) + model.size(), sizeof(gigabytes),
                reinterpret_cast<const char*>(&gigabytes), sizeof(gigabytes));
  std::ofstream(file(), std::ios::binary | std::ios::trunc) << bytes;
  EXPECT_THAT([this] { open_bag(file()); },
              ThrowsMessage<Error>(AllOf(HasSubstr("damaged"), HasSubstr("longer than 256 MB"))));
}

TEST_F(BagSourceTest, WhateverBytesAreWrongItIsOneLineOrFrames) {
  {
    TestBag bag(file());
    bag.info("/camera/rgb/camera_info", 1.0, {6, 4}, 500.0);
    for (int i = 0; i < 4; ++i) {
      bag.image("/camera/rgb/image_color", 1.0 + i / 10.0, TestBag::pattern(), "bgr8");
      bag.image("/camera/depth/image", 1.0 + i / 10.0, cv::Mat(4, 6, CV_16UC1, cv::Scalar(1500)),
                "16UC1");
    }
  }
  const std::string whole = content(file());
  const auto read_all = [this] {
    try {
      const auto bag = open_bag(file());
      if (!bag->own_camera()) return false;
      bag->use_camera(*bag->own_camera());
      while (bag->read()) {
      }
      return true;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return false;
    }
  };
  ASSERT_TRUE(read_all());
  std::mt19937 random(1);
  int refused = 0;
  for (int round = 0; round < 300; ++round) {
    std::string bytes = whole;
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes) {
      const std::size_t at = random() % bytes.size();
      switch (random() % 4) {
        case 0:
          bytes[at] = static_cast<char>(random());
          break;
        case 1:
          bytes.replace(at, std::min<std::size_t>(4, bytes.size() - at), "\xff\xff\xff\xff");
          break;
        case 2:
          bytes.erase(at, random() % 20);
          break;
        case 3:
          bytes.resize(std::max<std::size_t>(at, 13));
          break;
      }
    }
    std::ofstream(file(), std::ios::binary) << bytes;
    refused += !read_all();
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace dkp_slam
