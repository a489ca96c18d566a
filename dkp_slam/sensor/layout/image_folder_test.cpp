#include "dkp_slam/sensor/layout/image_folder.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/images/image_file.h"
#include "dkp_slam/map_file/test_folder.h"
#include "dkp_slam/sensor/camera_config.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const char* const unit_matrix = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

Camera camera_of(int width, int height, double focal) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = width / 2.0;
  camera.cy = height / 2.0;
  camera.depth_scale = 1000.0;
  return camera;
}

class ImageFolder : public testing::FolderTest {
 protected:
  void image(const std::string& name, const cv::Mat& image) const {
    fs::create_directories((folder_ / name).parent_path());
    write_image(folder_ / name, image);
  }
  void text(const std::string& name, const std::string& content) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << content;
  }
  static cv::Mat colour(int width, int height, int value = 100) {
    return {height, width, CV_8UC3, cv::Scalar(value, value, value)};
  }
  static cv::Mat depth(int width, int height, int value) {
    return {height, width, CV_16UC1, cv::Scalar(value)};
  }
  /// The message of the error that it throws, one line.
  static std::string error_of(const std::function<void()>& work) {
    try {
      work();
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "no error";
  }
  std::string open_error(const Camera& camera) const {
    return error_of([&] { open_image_folder(folder_, camera); });
  }
  std::string truth_error() const {
    return error_of([&] { layout_truth(folder_); });
  }
  static Eigen::Vector3d translation(const StampedPose& pose) {
    return pose.world_from_camera.translation;
  }
};

// ICL-NUIM.

TEST_F(ImageFolder, OfIclNuimIsReadInTheOrderOfNumbersAtTheStatedRate) {
  for (const int i : {0, 2, 10}) {
    image("rgb/" + std::to_string(i) + ".png", colour(32, 24, i));
    image("depth/" + std::to_string(i) + ".png", depth(32, 24, 5000));
  }
  image("rgb/3.png", colour(32, 24));
  EXPECT_EQ(layout_of(folder_), FolderLayout::icl_nuim);
  EXPECT_FALSE(own_camera(folder_));
  // Anybody's images may be numbered.
  EXPECT_EQ(published_camera(folder_), "");
  Camera camera = camera_of(32, 24, 30.0);
  camera.depth_scale = 5000.0;
  const auto source = open_image_folder(folder_, camera, {}, 20.0);
  EXPECT_EQ(source->size(), 3U);
  for (const int i : {0, 2, 10}) {
    const auto frame = source->read();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->timestamp, i / 20.0);
    EXPECT_EQ(frame->depth_delay, 0.0);
    EXPECT_EQ(frame->colour.at<cv::Vec3b>(3, 3)[0], i);
    EXPECT_EQ(frame->depth.at<float>(3, 3), 1.0F);
  }
  EXPECT_FALSE(source->read());
  TumOptions later;
  later.first_frame = 1;
  later.frame_limit = 1;
  EXPECT_EQ(open_image_folder(folder_, camera, later)->read()->timestamp, 2.0 / 30.0);
  EXPECT_THAT(error_of([&] { open_image_folder(folder_, camera, {}, 0.0); }),
              HasSubstr("frame rate must be above 0"));
  // Lists with time stamps go before.
  text("rgb.txt", "");
  EXPECT_EQ(layout_of(folder_), FolderLayout::tum);
}

TEST_F(ImageFolder, OfIclNuimMayBringAssociationsThatCountImages) {
  for (const int i : {1, 2}) {
    image("rgb/" + std::to_string(i) + ".png", colour(32, 24, i));
    image("depth/" + std::to_string(i) + ".png", depth(32, 24, 5000));
  }
  text("associations.txt", "1 depth/1.png 1 rgb/1.png\n2 depth/2.png 2 rgb/2.png\n");
  EXPECT_EQ(layout_of(folder_), FolderLayout::icl_nuim);
  EXPECT_EQ(published_camera(folder_), "icl_nuim.yaml");
  const auto source = open_image_folder(folder_, camera_of(32, 24, 30.0));
  EXPECT_EQ(source->read()->timestamp, 1.0 / 30.0);
  // What tells the time is TUM's.
  text("associations.txt", "1.5 depth/1.png 1.5 rgb/1.png\n");
  EXPECT_EQ(layout_of(folder_), FolderLayout::tum);
  EXPECT_EQ(open_image_folder(folder_, camera_of(32, 24, 30.0))->read()->timestamp, 1.5);
}

TEST_F(ImageFolder, OfIclNuimHasATruePathWhoseYAxisIsMirrored) {
  image("rgb/1.png", colour(32, 24));
  image("depth/1.png", depth(32, 24, 5000));
  // A tenth of a radian about x, then about y.
  const double s = std::sin(0.05), c = std::cos(0.05);
  text("livingRoom0.gt.freiburg", fmt::format("1 1 2 3 {0} 0 0 {1}\n2 1 2 3 0 {0} 0 {1}\n", s, c));
  EXPECT_EQ(published_camera(folder_), "icl_nuim.yaml");
  const Trajectory path = layout_truth(folder_, 10.0);
  ASSERT_EQ(path.size(), 2U);
  EXPECT_EQ(path[1].timestamp, 0.2);
  EXPECT_EQ(translation(path[0]), Eigen::Vector3d(1.0, -2.0, 3.0));
  // A point that the mirrored camera sees is the mirrored point.
  const Eigen::Vector3d point(0.3, 0.5, 2.0), mirror(1.0, -1.0, 1.0);
  const Eigen::AngleAxisd about[] = {{0.1, Eigen::Vector3d::UnitX()},
                                     {0.1, Eigen::Vector3d::UnitY()}};
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d theirs = about[i] * point + Eigen::Vector3d(1.0, 2.0, 3.0);
    const Eigen::Vector3d ours =
        path[std::size_t(i)].world_from_camera * point.cwiseProduct(mirror).eval();
    EXPECT_LT((ours - theirs.cwiseProduct(mirror)).norm(), 1e-9);
  }
  text("livingRoom1.gt.freiburg", "");
  EXPECT_THAT(truth_error(),
              HasSubstr("livingRoom0.gt.freiburg and livingRoom1.gt.freiburg: keep"));
  fs::remove(folder_ / "livingRoom1.gt.freiburg");
  text("livingRoom0.gt.freiburg", "1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n");
  EXPECT_THAT(truth_error(), HasSubstr("livingRoom0.gt.freiburg:2: the images' numbers must rise"));
  text("livingRoom0.gt.freiburg", "1 0 0 0 0 0 0\n");
  EXPECT_THAT(truth_error(), HasSubstr(":1: expected \"N tx ty tz qx qy qz qw\""));
  text("livingRoom0.gt.freiburg", "# number\n1 0 0 0 0 0 0 nan\n");
  EXPECT_THAT(truth_error(), HasSubstr(":2: \"nan\" is no number"));
  text("livingRoom0.gt.freiburg", "1 0 0 0 0 0 0 0\n");
  EXPECT_THAT(truth_error(), HasSubstr("quaternion is no rotation"));
  // The same file by another name; and a path by the clock, which is nobody's of this layout.
  fs::remove(folder_ / "livingRoom0.gt.freiburg");
  text("groundtruth.txt", "30 1 2 3 0 0 0 1\n");
  EXPECT_EQ(layout_truth(folder_).at(0).timestamp, 1.0);
  EXPECT_EQ(translation(layout_truth(folder_)[0]).y(), -2.0);
  text("groundtruth.txt", "0.5 1 2 3 0 0 0 1\n");
  EXPECT_TRUE(layout_truth(folder_).empty());
}

// 7-Scenes.

class SevenScenesFolder : public ImageFolder {
 protected:
  /// The left part of the image one metre away, the right one four.
  static constexpr int edge = 300;
  void SetUp() override {
    ImageFolder::SetUp();
    cv::Mat units = depth(640, 480, 1000);
    units.colRange(edge, 640).setTo(4000);
    units.rowRange(200, 210).setTo(65535);
    image("frame-000000.color.png", colour(640, 480));
    image("frame-000000.depth.png", units);
    text("frame-000000.pose.txt", unit_matrix);
  }
  /// As the dataset's are taken to be.
  static Camera colour_camera() { return camera_of(640, 480, 525.0); }
};

TEST_F(SevenScenesFolder, DepthIsRegisteredToColour) {
  EXPECT_EQ(layout_of(folder_), FolderLayout::seven_scenes);
  EXPECT_EQ(published_camera(folder_), "seven_scenes.yaml");
  Camera camera = colour_camera();
  camera.max_depth = 100.0;  // 65535 is unknown all the same
  const auto frame = open_image_folder(folder_, camera)->read();
  ASSERT_TRUE(frame);
  // A column u of the depth camera at z lies at 525 ((u - 320) / 585 - 0.025 / z) + 320.
  const auto column = [](double u, double z) {
    return 525.0 * ((u - 320.0) / 585.0 - 0.025 / z) + 320.0;
  };
  constexpr int row = 240;
  const double near_end = column(edge - 0.5, 1.0), far_begin = column(edge - 0.5, 4.0);
  ASSERT_LT(near_end, far_begin);  // what the near part hides from the depth camera alone
  const auto at = [&](double u) { return frame->depth.at<float>(row, static_cast<int>(u)); };
  EXPECT_EQ(at(std::floor(near_end)), 1.0F);
  EXPECT_EQ(at(std::ceil(near_end)), 0.0F);
  EXPECT_EQ(at(std::floor(far_begin)), 0.0F);
  EXPECT_EQ(at(std::ceil(far_begin)), 4.0F);
  EXPECT_EQ(at(std::floor(column(-0.5, 1.0))), 0.0F);
  EXPECT_EQ(at(std::ceil(column(-0.5, 1.0))), 1.0F);
  const auto unknown_row = static_cast<int>(std::lround(525.0 * (205.0 - 240.0) / 585.0 + 240.0));
  EXPECT_EQ(cv::countNonZero(frame->depth.row(unknown_row)), 0);
}

TEST_F(SevenScenesFolder, ThePosesAreThoseOfTheDepthCamera) {
  text("frame-000003.pose.txt", "0 0 1 5\n0 1 0 6\n-1 0 0 7\n0 0 0 1\n");  // looks along x
  text("frame-000001.pose.txt", "nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const Trajectory path = layout_truth(folder_);
  ASSERT_EQ(path.size(), 2U);
  EXPECT_TRUE(translation(path[0]).isApprox(Eigen::Vector3d(0.025, 0.0, 0.0)));
  EXPECT_EQ(path[1].timestamp, 0.1);
  EXPECT_TRUE(translation(path[1]).isApprox(Eigen::Vector3d(5.0, 6.0, 7.0 - 0.025)));
  text("frame-000002.pose.txt", "1 2 3\n");
  EXPECT_THAT(truth_error(), HasSubstr("frame-000002.pose.txt: has 3 numbers"));
}

TEST_F(SevenScenesFolder, WrongSizesAndMissingPartnersAreSaid) {
  EXPECT_THAT(open_error(camera_of(320, 240, 260.0)), HasSubstr("the camera file says 320 x 240"));
  image("frame-000000.depth.png", depth(320, 240, 1000));
  EXPECT_THAT(open_error(colour_camera()), HasSubstr("depth image is 320 x 240 pixels, not 640"));
  image("frame-000000.depth.png", colour(640, 480));
  EXPECT_THAT(open_error(colour_camera()), HasSubstr("depth must be a 16-bit image"));
  fs::remove(folder_ / "frame-000000.depth.png");
  EXPECT_THAT(open_error(colour_camera()), HasSubstr("none of 1 colour images has the number"));
}

// ScanNet.

class ScanNetFolder : public ImageFolder {
 protected:
  static constexpr int width = 64, height = 48;  // of depth
  void SetUp() override {
    ImageFolder::SetUp();
    // A ramp along x / z, from -0.5 to 0.5, and blue along y / z.
    cv::Mat ramp(97, 131, CV_8UC3);
    for (int y = 0; y < ramp.rows; ++y) {
      for (int x = 0; x < ramp.cols; ++x) {
        ramp.at<cv::Vec3b>(y, x) = ramp_at((x - 64.0) / 120.0, (y - 48.0) / 122.0);
      }
    }
    for (const char* number : {"0", "2", "10"}) {
      image(fmt::format("color/{}.png", number), ramp);
      image(fmt::format("depth/{}.png", number), depth(width, height, 1500));
      text(fmt::format("pose/{}.txt", number), unit_matrix);
    }
    text("intrinsic/intrinsic_color.txt", "120 0 64 0\n0 122 48 0\n0 0 1 0\n0 0 0 1\n");
    text("intrinsic/intrinsic_depth.txt", "57 0 32.3 0\n0 58 23.8 0\n0 0 1 0\n0 0 0 1\n");
    text("intrinsic/extrinsic_color.txt", unit_matrix);
  }
  static cv::Vec3b ramp_at(double x, double y) {
    return {cv::saturate_cast<uchar>(127.5 + 200.0 * y), 0,
            cv::saturate_cast<uchar>(127.5 + 200.0 * x)};
  }
};

TEST_F(ScanNetFolder, ColourIsResampledIntoThePixelsOfDepth) {
  EXPECT_EQ(layout_of(folder_), FolderLayout::scannet);
  const auto camera = own_camera(folder_);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, width);
  EXPECT_EQ(camera->height, height);
  EXPECT_EQ(camera->cx, 32.3);
  EXPECT_EQ(camera->depth_scale, 1000.0);
  const auto source = open_image_folder(folder_, *camera);
  EXPECT_EQ(source->size(), 3U);
  const auto frame = source->read();
  ASSERT_TRUE(frame);
  ASSERT_EQ(frame->colour.size(), cv::Size(width, height));
  EXPECT_EQ(cv::countNonZero(frame->depth != 1.5F), 0);
  for (int y = 2; y < height - 2; ++y) {
    for (int x = 2; x < width - 2; ++x) {
      const cv::Vec3b expected = ramp_at((x - 32.3) / 57.0, (y - 23.8) / 58.0);
      const cv::Vec3b seen = frame->colour.at<cv::Vec3b>(y, x);
      ASSERT_NEAR(seen[0], expected[0], 1.5) << x << ' ' << y;
      ASSERT_NEAR(seen[2], expected[2], 1.5) << x << ' ' << y;
    }
  }
  EXPECT_EQ(source->read()->timestamp, 2.0 / 30.0);
  EXPECT_EQ(source->read()->timestamp, 10.0 / 30.0);
}

TEST_F(ScanNetFolder, UnknownPosesAreLeftOutOfTheTrueOnes) {
  const std::string unknown = "-inf -inf -inf -inf\n";
  text("pose/2.txt", unknown + unknown + unknown + unknown);
  text("pose/10.txt", "1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n");
  const Trajectory path = layout_truth(folder_, 10.0);
  ASSERT_EQ(path.size(), 2U);
  EXPECT_EQ(path[1].timestamp, 1.0);
  EXPECT_EQ(translation(path[1]), Eigen::Vector3d(5.0, 6.0, 7.0));
}

TEST_F(ScanNetFolder, WhatDoesNotFitIsSaid) {
  const Camera camera = *own_camera(folder_);
  EXPECT_THAT(open_error(camera_of(60, 48, 50.0)), HasSubstr("the camera file says 60 x 48"));
  text("intrinsic/extrinsic_depth.txt", "1 0 0 0.1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_THAT(open_error(camera), HasSubstr("extrinsic_depth.txt: must be the identity"));
  fs::remove(folder_ / "intrinsic/extrinsic_depth.txt");
  // Resized, but not its numbers.
  text("intrinsic/intrinsic_color.txt", "240 0 128 0\n0 244 96 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_THAT(open_error(camera), HasSubstr("were they resized?"));
  text("intrinsic/intrinsic_color.txt", "240 0 128\n");
  EXPECT_THAT(open_error(camera), HasSubstr("intrinsic_color.txt: has 3 numbers"));
  fs::remove(folder_ / "intrinsic/intrinsic_color.txt");
  EXPECT_THAT(open_error(camera), HasSubstr("no intrinsic/intrinsic_color.txt in this folder"));
  // Where parts of the dataset that come ready made have them.
  text("intrinsics_color.txt", "120 0 64 0\n0 122 48 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_EQ(open_error(camera), "no error");
  fs::remove(folder_ / "intrinsic/intrinsic_depth.txt");
  EXPECT_THAT(error_of([&] { own_camera(folder_); }),
              HasSubstr("no intrinsic/intrinsic_depth.txt"));
}

TEST_F(ScanNetFolder, ImagesOfAnotherSizeAreSkippedAndCounted) {
  image("color/2.png", colour(100, 80));
  text("depth/10.png", "no image");
  const auto source = open_image_folder(folder_, *own_camera(folder_));
  EXPECT_TRUE(source->read());
  EXPECT_THAT(error_of([&] { source->read(); }), HasSubstr("2 of 3 frames cannot be read"));
  EXPECT_EQ(source->skipped(), 2U);
}

TEST_F(ImageFolder, NothingThatIsKnownIsSaidAsATumFolder) {
  EXPECT_EQ(layout_of(folder_), FolderLayout::tum);
  EXPECT_EQ(layout_of(folder_ / "none"), FolderLayout::tum);
  EXPECT_TRUE(layout_truth(folder_).empty());
  EXPECT_THAT(open_error(camera_of(64, 48, 50.0)), HasSubstr("no rgb.txt in this folder"));
  EXPECT_THAT(error_of([&] { open_image_folder(folder_ / "none", camera_of(64, 48, 50.0)); }),
              HasSubstr("none: no such folder"));
}

TEST(PublishedCameras, AreThoseOfTheDatasetsPages) {
  const std::string folder = DKP_SLAM_CONFIG_FOLDER;
  const Camera icl = load_camera(folder + "/icl_nuim.yaml");
  EXPECT_EQ(icl.fx, 481.2);
  EXPECT_EQ(icl.fy, 480.0);
  EXPECT_EQ(icl.depth_scale, 5000.0);
  EXPECT_EQ(icl.readout, 0.0);
  const Camera scenes = load_camera(folder + "/seven_scenes.yaml");
  EXPECT_EQ(scenes.cx, 320.0);
  EXPECT_EQ(scenes.depth_scale, 1000.0);
}

}  // namespace
}  // namespace dkp_slam
