#include "dkp_slam/sensor/tum_source.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <opencv2/imgcodecs.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/camera_config.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int width = 32;
constexpr int height = 24;

Camera small_camera() {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 30.0;
  camera.cx = width / 2.0;
  camera.cy = height / 2.0;
  camera.min_depth = 0.5;
  camera.max_depth = 4.0;
  return camera;
}

/// A folder of ten frames: frame i is at i seconds, its colour is (i, 2 i, 3 i), its depth i / 2
/// metres, its depth image 5 ms late.
class TumSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("tum_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "rgb");
    fs::create_directories(folder_ / "depth");
    for (int i = 0; i < 10; ++i) {
      cv::imwrite(colour(i), cv::Mat(height, width, CV_8UC3, cv::Scalar(i, 2 * i, 3 * i)));
      cv::imwrite(depth(i), cv::Mat(height, width, CV_16UC1, cv::Scalar(i * 2500)));
    }
    write_lists();
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string colour(int i) const { return folder_ / "rgb" / (std::to_string(i) + ".png"); }
  std::string depth(int i) const { return folder_ / "depth" / (std::to_string(i) + ".png"); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  void write_lists() const {
    std::string rgb_lines = "# timestamp filename\n", depth_lines;
    for (int i = 0; i < 10; ++i) {
      const std::string n = std::to_string(i);
      rgb_lines += n + ".000 rgb/" + n + ".png\n";
      depth_lines += n + ".005 depth/" + n + ".png\n";
    }
    write("rgb.txt", rgb_lines);
    write("depth.txt", depth_lines);
  }
  std::unique_ptr<RgbdSource> open(const TumOptions& options = {},
                                   const Camera& camera = small_camera()) const {
    return open_tum_folder(folder_, camera, options);
  }
  /// The message of the error that opening and reading everything gives.
  std::string error() const {
    try {
      const auto source = open();
      while (source->read()) {
      }
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "no error";
  }
  void write_mask(int i, int value) const {
    fs::create_directories(folder_ / "mask");
    cv::imwrite(folder_ / "mask" / (std::to_string(i) + ".png"),
                cv::Mat(height, width, CV_8UC1, cv::Scalar(value)));
  }
  static std::vector<int> indices(RgbdSource* source) {
    std::vector<int> result;
    while (const auto frame = source->read()) result.push_back(frame->index);
    return result;
  }
  static void truncate(const std::string& path) { fs::resize_file(path, fs::file_size(path) / 2); }

  fs::path folder_;
};

TEST_F(TumSourceTest, ReadsColourDepthAndStamps) {
  const auto source = open();
  EXPECT_EQ(source->description(), folder_.string());
  EXPECT_EQ(source->size(), 10U);
  for (int i = 0; i < 10; ++i) {
    const auto frame = source->read();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
    EXPECT_EQ(frame->timestamp, i);
    ASSERT_EQ(frame->colour.type(), CV_8UC3);
    ASSERT_EQ(frame->depth.type(), CV_32FC1);
    EXPECT_EQ(frame->colour.at<cv::Vec3b>(3, 5), cv::Vec3b(i, 2 * i, 3 * i));
    // 0.5 m and 4.0 m, the range's ends, belong to it; 0 and 4.5 m do not.
    EXPECT_EQ(frame->depth.at<float>(3, 5), i >= 1 && i <= 8 ? 0.5F * i : 0.0F);
  }
  EXPECT_FALSE(source->read());
  EXPECT_EQ(source->skipped(), 0U);
}

TEST_F(TumSourceTest, StartAndLimit) {
  TumOptions options;
  options.first_frame = 3;
  options.frame_limit = 4;
  const auto source = open(options);
  EXPECT_EQ(source->size(), 4U);
  const auto frame = source->read();
  EXPECT_EQ(frame->index, 0);
  EXPECT_EQ(frame->timestamp, 3.0);
  EXPECT_EQ(indices(source.get()), (std::vector<int>{1, 2, 3}));
  options.first_frame = 10;
  EXPECT_THROW(open(options), Error);
}

TEST_F(TumSourceTest, AssociationsFileGoesBeforeStamps) {
  write("associations.txt", "7.105 depth/7.png 7 rgb/7.png\n4.1 depth/5.png 4 rgb/4.png\n");
  const auto source = open();
  EXPECT_EQ(source->size(), 2U);
  const auto frame = source->read();
  EXPECT_EQ(frame->timestamp, 4.0);
  EXPECT_EQ(frame->colour.at<cv::Vec3b>(0, 0)[0], 4);
  EXPECT_EQ(frame->depth.at<float>(0, 0), 2.5F);
}

/// Frame i is at i seconds and its depth image is stamped 5 ms later; but it was taken 0.7 s before
/// that, so that image i + 1 is the one that was taken nearest to it.
TEST_F(TumSourceTest, PairsByTheMomentWhenDepthIsTakenBesideItsStamp) {
  write("associations.txt",
        "1.000 rgb/1.png 1.005 depth/1.png\n2.000 rgb/2.png 2.005 depth/2.png\n"
        "3.000 rgb/3.png 3.005 depth/3.png\n");
  TumOptions options;
  Camera camera = small_camera();
  camera.depth_correction.delay = -0.7;
  const auto listed = open(options, camera);
  for (const auto& [number, delay, by_stamp] :
       std::vector<std::tuple<int, double, int>>{{2, 0.305, 1}, {3, 0.305, 2}, {3, -0.695, 0}}) {
    const auto frame = listed->read();
    ASSERT_TRUE(frame);
    EXPECT_FLOAT_EQ(frame->depth.at<float>(0, 0), 0.5F * static_cast<float>(number));
    EXPECT_NEAR(frame->depth_delay, delay, 1e-9);
    ASSERT_EQ(frame->stamped_depth.empty(), by_stamp == 0);
    if (by_stamp == 0) continue;
    EXPECT_FLOAT_EQ(frame->stamped_depth.at<float>(0, 0), 0.5F * static_cast<float>(by_stamp));
  }
  EXPECT_FALSE(listed->read());

  fs::remove(folder_ / "associations.txt");
  options.max_difference = 0.4;
  const auto stamped = open(options, camera);
  const auto first = stamped->read();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->timestamp, 0.0);
  EXPECT_NEAR(first->depth_delay, 0.305, 1e-9);
  const auto second = stamped->read();
  EXPECT_FLOAT_EQ(second->depth.at<float>(0, 0), 1.0F);
  EXPECT_FLOAT_EQ(second->stamped_depth.at<float>(0, 0), 0.5F);
}

TEST_F(TumSourceTest, DoesWithoutTheDepthOfTheStampsWhereThatCannotBeRead) {
  write("associations.txt",
        "1.000 rgb/1.png 1.005 depth/1.png\n2.000 rgb/2.png 2.005 depth/2.png\n");
  truncate(folder_ / "depth" / "1.png");
  Camera camera = small_camera();
  camera.depth_correction.delay = -0.7;
  const auto source = open({}, camera);
  const auto frame = source->read();
  ASSERT_TRUE(frame);
  EXPECT_FLOAT_EQ(frame->depth.at<float>(0, 0), 1.0F);
  EXPECT_TRUE(frame->stamped_depth.empty());
  EXPECT_EQ(source->skipped(), 0U);
  EXPECT_TRUE(open()->read()->stamped_depth.empty()) << "no delay is known";
}

TEST_F(TumSourceTest, PutsDepthRight) {
  Camera camera = small_camera();
  camera.depth_correction.bias = 0.25;
  camera.depth_correction.distortion.coefficients << 0.1, 0, 0, 0, 0, 0, 0, 0, 0;
  const auto source = open({}, camera);
  for (int i = 0; i < 4; ++i) source->read();
  const cv::Mat depth = source->read()->depth;  // 2 m everywhere
  EXPECT_FLOAT_EQ(depth.at<float>(3, width / 2), 2.25F);
  EXPECT_FLOAT_EQ(depth.at<float>(3, 0), 1.0F / (0.5F - 0.1F) + 0.25F);
  EXPECT_FLOAT_EQ(depth.at<float>(20, 3 * width / 4), 1.0F / (0.5F + 0.05F) + 0.25F);
}

TEST_F(TumSourceTest, TakesJpegAndGreyAndDeepAndAlphaColour) {
  const cv::Mat flat(height, width, CV_8UC3, cv::Scalar(10, 100, 200));
  cv::imwrite(folder_ / "rgb/0.jpg", flat);
  cv::imwrite(colour(1), cv::Mat(height, width, CV_8UC1, cv::Scalar(77)));
  cv::imwrite(colour(2), cv::Mat(height, width, CV_8UC4, cv::Scalar(1, 2, 3, 128)));
  cv::imwrite(colour(3), cv::Mat(height, width, CV_16UC1, cv::Scalar(257 * 9)));
  write("rgb.txt", "0 rgb/0.jpg\n1 rgb/1.png\n2 rgb/2.png\n3 rgb/3.png\n");
  const auto source = open();
  const std::vector<cv::Vec3b> expected = {{10, 100, 200}, {77, 77, 77}, {1, 2, 3}, {9, 9, 9}};
  for (const cv::Vec3b& bgr : expected) {
    const auto frame = source->read();
    ASSERT_TRUE(frame);
    ASSERT_EQ(frame->colour.type(), CV_8UC3);
    EXPECT_LE(cv::norm(frame->colour.at<cv::Vec3b>(5, 5), bgr, cv::NORM_INF), 3.0);
  }
}

TEST_F(TumSourceTest, SkipsAndCountsWhatCannotBeRead) {
  truncate(colour(0));
  truncate(depth(3));
  fs::remove(colour(5));
  std::ofstream(colour(7), std::ios::trunc) << "";
  std::ofstream(colour(8), std::ios::trunc) << "this is no image";
  const auto source = open();
  EXPECT_EQ(indices(source.get()), (std::vector<int>{1, 2, 4, 6, 9}));
  EXPECT_EQ(source->skipped(), 5U);
}

TEST_F(TumSourceTest, SkipsWhatIsNoFile) {
  for (const std::string& path : {colour(1), depth(3), colour(5), colour(7)}) fs::remove(path);
  fs::create_directory(colour(1));
  ASSERT_EQ(mkfifo(depth(3).c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", colour(5));
  fs::create_symlink(colour(7), colour(7));
  const auto source = open();
  EXPECT_EQ(indices(source.get()), (std::vector<int>{0, 2, 4, 6, 8, 9}));
}

TEST_F(TumSourceTest, SkipsImagesOfTheWrongKindAmongRightOnes) {
  cv::imwrite(depth(4), cv::Mat(height, width, CV_8UC1, cv::Scalar(9)));
  cv::imwrite(depth(6), cv::Mat(height / 2, width / 2, CV_16UC1, cv::Scalar(2500)));
  cv::imwrite(colour(8), cv::Mat(height * 2, width * 2, CV_8UC3, cv::Scalar(9)));
  const auto source = open();
  EXPECT_EQ(indices(source.get()), (std::vector<int>{0, 1, 2, 3, 5, 7, 9}));
  EXPECT_EQ(source->skipped(), 3U);
}

TEST_F(TumSourceTest, RefusesListsThatAreNoFiles) {
  fs::remove(folder_ / "rgb.txt");
  ASSERT_EQ(mkfifo((folder_ / "rgb.txt").c_str(), 0600), 0);
  EXPECT_THAT(error(), HasSubstr("rgb.txt: cannot be read: it is a pipe or a device"));
  fs::remove(folder_ / "rgb.txt");
  fs::create_directory(folder_ / "rgb.txt");
  EXPECT_THAT(error(), HasSubstr("rgb.txt: cannot be read: it is a folder"));
}

TEST_F(TumSourceTest, SkipsTruncatedJpeg) {
  for (int i = 0; i < 10; ++i) {
    const std::string path = folder_ / "rgb" / (std::to_string(i) + ".jpg");
    cv::Mat noise(height, width, CV_8UC3);
    cv::randu(noise, 0, 255);
    cv::imwrite(path, noise);
  }
  truncate(folder_ / "rgb/4.jpg");
  std::string list;
  for (int i = 0; i < 10; ++i) list += std::to_string(i) + " rgb/" + std::to_string(i) + ".jpg\n";
  write("rgb.txt", list);
  const auto source = open();
  EXPECT_EQ(indices(source.get()).size(), 9U);
  EXPECT_EQ(source->skipped(), 1U);
}

TEST_F(TumSourceTest, FailsWhenMoreThanHalfIsLost) {
  for (int i = 2; i < 8; ++i) truncate(colour(i));
  const auto source = open();
  EXPECT_TRUE(source->read());
  EXPECT_TRUE(source->read());
  EXPECT_THROW(source->read(), Error);
  EXPECT_THAT(error(), HasSubstr("6 of 10 frames cannot be read"));
}

TEST_F(TumSourceTest, NamesWhatTheFolderLacks) {
  EXPECT_THROW(open_tum_folder("/no/such/folder", small_camera()), Error);
  EXPECT_THROW(open_tum_folder(folder_ / "rgb.txt", small_camera()), Error);
  fs::create_directories(folder_ / "empty");
  EXPECT_THROW(open_tum_folder(folder_ / "empty", small_camera()), Error);
  fs::remove(folder_ / "depth.txt");
  EXPECT_THAT(error(), HasSubstr("no depth.txt"));
  fs::remove(folder_ / "rgb.txt");
  EXPECT_THAT(error(), HasSubstr("no rgb.txt"));
  write("rgb.txt", "# nothing\n");
  write("depth.txt", "");
  EXPECT_THAT(error(), HasSubstr("none of 0 colour images"));
  write_lists();
  write("depth.txt", "0.5 depth/0.png\n1.02 depth/1.png\n");
  EXPECT_THAT(error(), HasSubstr("none of 10 colour images has one of 2 depth images"));
  write("associations.txt", "# nothing\n");
  EXPECT_THAT(error(), HasSubstr("associations.txt: names no images"));
  write("associations.txt", "1 rgb/1.png\n");
  EXPECT_THAT(error(), HasSubstr("associations.txt:1: expected"));
}

TEST_F(TumSourceTest, RefusesWrongDepthTypes) {
  cv::imwrite(depth(0), cv::Mat(height, width, CV_8UC1, cv::Scalar(9)));
  EXPECT_THAT(error(), HasSubstr("16-bit image of one channel, not 8 bits and 1 channels"));
  cv::imwrite(depth(0), cv::Mat(height, width, CV_8UC3, cv::Scalar(9)));
  EXPECT_THAT(error(), HasSubstr("not 8 bits and 3 channels"));
  cv::imwrite(depth(0), cv::Mat(height, width, CV_16UC3, cv::Scalar(9)));
  EXPECT_THAT(error(), HasSubstr("3 channels"));
  EXPECT_THROW(open(), Error) << "known before the run starts";
}

TEST_F(TumSourceTest, RefusesSizesThatDiffer) {
  cv::imwrite(depth(0), cv::Mat(height / 2, width / 2, CV_16UC1, cv::Scalar(2500)));
  EXPECT_THAT(error(), HasSubstr("depth is 16 x 12 pixels but its colour image is 32 x 24"));
  cv::imwrite(colour(0), cv::Mat(height / 2, width / 2, CV_8UC3, cv::Scalar(9)));
  EXPECT_THAT(error(), HasSubstr("is 16 x 12 pixels but the camera file says 32 x 24"));
  Camera broken = small_camera();
  broken.fx = 0.0;
  EXPECT_THROW(open_tum_folder(folder_, broken), Error);
}

TEST_F(TumSourceTest, MasksComeWithTheirImages) {
  TumOptions options;
  options.masks = folder_ / "mask";
  EXPECT_THROW(open(options), Error) << "no such folder";
  for (const int i : {0, 1, 3}) write_mask(i, 40 + i);
  const auto source = open(options);
  for (int i = 0; i < 4; ++i) {
    const auto frame = source->read();
    ASSERT_EQ(frame->mask.empty(), i == 2);
    const cv::Mat wanted(height, width, CV_8UC1, cv::Scalar(40 + i));
    EXPECT_TRUE(i == 2 || cv::norm(frame->mask, wanted, cv::NORM_INF) == 0.0) << i;
  }
  EXPECT_EQ(source->without_mask(), 1U);
  EXPECT_TRUE(open()->read()->mask.empty()) << "nobody asked for masks";
  cv::imwrite(folder_ / "mask" / "0.png", cv::Mat(height / 2, width, CV_8UC1, cv::Scalar(0)));
  EXPECT_THROW(open(options), Error) << "known before the run starts";
}

TEST(TumSource, ReadsRealSequencesAsOpenCvDoes) {
  const char* data = std::getenv("DKP_SLAM_DATA");
  if (data == nullptr) GTEST_SKIP() << "DKP_SLAM_DATA names no folder of sequences";
  const fs::path folder = fs::path(data) / "fr1_xyz";
  const Camera camera = load_camera(DKP_SLAM_CONFIG_FOLDER "/tum_fr1.yaml").of_corrected_images();
  TumOptions options;
  options.frame_limit = 5;
  const auto source = open_tum_folder(folder, camera, options);
  std::ifstream list(folder / "associations.txt");
  std::string t1, f1, t2, f2;
  while (const auto frame = source->read()) {
    list >> t1 >> f1 >> t2 >> f2;
    EXPECT_EQ(frame->timestamp, std::stod(t1));
    EXPECT_EQ(cv::norm(frame->colour, cv::imread(folder / f1), cv::NORM_INF), 0.0);
    cv::Mat depth;
    cv::imread(folder / f2, cv::IMREAD_UNCHANGED).convertTo(depth, CV_32F, 1.0 / 5000.0);
    depth.setTo(0, (depth < 0.2999) | (depth > 8.0001));
    EXPECT_LE(cv::norm(frame->depth, depth, cv::NORM_INF), 1e-6);
  }
}

}  // namespace
}  // namespace dkp_slam
