#include "dkp_slam/sensor/mask_folder.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/images/image_file.h"
#include "tests/support/image_files.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

const cv::Size image_size(32, 24);

/// Masks of two images, rgb/1.25.jpg and rgb/2.5.png; rgb/3.png has none.
class MaskFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("masks_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    mask_(cv::Rect(3, 4, 5, 6)) = 7;
    write_image(folder_ / "1.25.png", mask_);
    write_image(folder_ / "2.5.png", cv::Mat::zeros(image_size, CV_8UC1));
  }
  void TearDown() override { fs::remove_all(folder_); }

  MaskFolder open() const { return {folder_, images_}; }
  /// The second image's mask is refused for this reason, with its name, at once and when read.
  void expect_refused(const std::string& why) const {
    const auto message =
        ThrowsMessage<Error>(AllOf(HasSubstr("2.5.png: "), HasSubstr(why), Not(HasSubstr("\n"))));
    MaskFolder masks = open();
    EXPECT_THAT([&] { masks.read("rgb/2.5.png", image_size); }, message);
    EXPECT_THAT([&] { masks.check("rgb/2.5.png", image_size); }, message);
  }

  fs::path folder_;
  cv::Mat mask_ = cv::Mat::zeros(image_size, CV_8UC1);
  const std::vector<std::string> images_{"rgb/1.25.jpg", "rgb/2.5.png", "rgb/3.png"};
};

TEST_F(MaskFolderTest, MasksAreNamedLikeTheirImages) {
  MaskFolder masks = open();
  EXPECT_EQ(cv::norm(masks.read("rgb/1.25.jpg", image_size), mask_, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::countNonZero(masks.read("rgb/2.5.png", image_size)), 0);
  EXPECT_EQ(masks.missing(), 0U);
}

TEST_F(MaskFolderTest, AMissingOneIsNoMaskAndIsCounted) {
  MaskFolder masks = open();
  masks.check("rgb/3.png", image_size);
  EXPECT_EQ(masks.missing(), 0U);
  EXPECT_TRUE(masks.read("rgb/3.png", image_size).empty());
  EXPECT_TRUE(masks.read("rgb/3.png", image_size).empty());
  EXPECT_EQ(masks.missing(), 2U);
}

TEST_F(MaskFolderTest, AFolderWithoutAnyIsRefused) {
  EXPECT_THAT([&] { MaskFolder(folder_ / "none", images_); },
              ThrowsMessage<Error>(AllOf(HasSubstr("none"), HasSubstr("no such folder"))));
  const fs::path empty = folder_ / "empty";
  fs::create_directory(empty);
  EXPECT_THAT([&] { MaskFolder(empty, images_); },
              ThrowsMessage<Error>(AllOf(HasSubstr(empty.string()),
                                         HasSubstr("no mask for any of 3 colour images"),
                                         HasSubstr("rgb/1.25.jpg would be 1.25.png"))));
}

TEST_F(MaskFolderTest, WhatIsNoMaskOfThatImageIsRefused) {
  const std::string file = folder_ / "2.5.png";
  write_image(file, cv::Mat::zeros(12, 16, CV_8UC1));
  expect_refused("the mask is 16 x 12 pixels but its colour image 32 x 24");
  write_image(file, cv::Mat::zeros(image_size, CV_16UC1));
  expect_refused("not of 8-bit grey values but of 16 bits");
  write_image(file, cv::Mat::zeros(image_size, CV_8UC3));
  expect_refused("not of 8-bit grey values but of colours");
  write_image(file, mask_);
  fs::resize_file(file, fs::file_size(file) - 20);
  expect_refused("a mask is a PNG of 8-bit grey values");
  testing::write_image_as_named(folder_ / "2.5.jpg", mask_);
  fs::rename(folder_ / "2.5.jpg", file);
  expect_refused("not a PNG file");
}

}  // namespace
}  // namespace dkp_slam
