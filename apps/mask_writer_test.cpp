#include <filesystem>
#include <fstream>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/run_masks.h"
#include "dkp_slam/error.h"
#include "dkp_slam/map_file/test_folder.h"
#include "tests/support/image_files.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

class MaskWriterTest : public dkp_slam::testing::FolderTest {
 protected:
  static void tell(MaskWriter& writer, double time, const cv::Mat& mask) {
    FrameSnapshot frame;
    frame.frame.timestamp = time;
    frame.frame.colour = cv::Mat::zeros(6, 8, CV_8UC3);
    frame.dynamics.mask = mask;
    writer.on_frame(std::make_shared<FrameSnapshot>(std::move(frame)));
    writer.rethrow_failure();
  }
  cv::Mat written(const char* name) const {
    return testing::read_image(folder_ / masks_folder / name);
  }
};

TEST_F(MaskWriterTest, KeepsAMaskForEveryFrameAlsoWhereNobodyIs) {
  MaskWriter writer(folder_);
  cv::Mat mask = cv::Mat::zeros(6, 8, CV_8UC1);
  mask(cv::Rect(2, 1, 3, 4)).setTo(255);
  tell(writer, 1305031102.175304, mask);
  tell(writer, 12.0, {});
  EXPECT_EQ(cv::norm(written("1305031102.175304.png"), mask), 0.0);
  EXPECT_EQ(written("12.000000.png").size(), cv::Size(8, 6));
  EXPECT_EQ(cv::countNonZero(written("12.000000.png")), 0);
}

TEST_F(MaskWriterTest, NothingOfAnEarlierRunStays) {
  remove_masks(folder_);
  {
    MaskWriter writer(folder_);
    tell(writer, 1.0, {});
  }
  std::ofstream(folder_ / masks_folder / "mine.png") << "kept";
  MaskWriter writer(folder_);
  EXPECT_FALSE(fs::exists(folder_ / masks_folder / "1.000000.png"));
  tell(writer, 2.0, {});
  remove_masks(folder_);
  EXPECT_FALSE(fs::exists(folder_ / masks_folder / "2.000000.png"));
  EXPECT_TRUE(fs::exists(folder_ / masks_folder / "mine.png"));
}

TEST_F(MaskWriterTest, WhatCannotBeWrittenIsSaid) {
  std::ofstream(folder_ / masks_folder) << "a file where the folder belongs";
  EXPECT_THROW(MaskWriter{folder_}, Error);
  fs::remove(folder_ / masks_folder);
  MaskWriter writer(folder_);
  fs::remove_all(folder_ / masks_folder);
  EXPECT_THROW(tell(writer, 1.0, {}), Error);
}

}  // namespace
}  // namespace dkp_slam::apps
