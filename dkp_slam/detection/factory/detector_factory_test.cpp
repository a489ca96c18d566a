#include "dkp_slam/detection/factory/detector_factory.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/detection/yolox/tiny_onnx.h"
#include "dkp_slam/error.h"
#include "tests/support/image_files.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

/// An empty folder that no other test uses: tests may run side by side.
fs::path fresh_folder() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  const fs::path folder = fs::path(::testing::TempDir()) / "dkp_slam_detection_test" /
                          test->test_suite_name() / test->name();
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

/// Sets an environment variable for the length of a scope.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    setenv(name, value.c_str(), 1);
  }
  ~ScopedVariable() { old_ ? setenv(name_, old_->c_str(), 1) : unsetenv(name_); }

 private:
  const char* name_;
  std::optional<std::string> old_;
};

class YoloxBackends : public ::testing::TestWithParam<YoloxBackend> {
 protected:
  void SetUp() override {
#ifndef DKP_SLAM_HAVE_ONNXRUNTIME
    if (GetParam() == YoloxBackend::onnxruntime) GTEST_SKIP() << "built without ONNX Runtime";
#endif
    options_.backend = GetParam();
    folder_ = fresh_folder();
    options_.model = folder_ / "yolox_test.onnx";
  }

  fs::path folder_;
  YoloxOptions options_;
};

TEST_P(YoloxBackends, FindsWhatTheImageSays) {
  // 32x32: 16 + 4 + 1 rows of 85. The model hands its input through, so values in the image's
  // blue, then green plane are the output.
  tiny_onnx::write_model(options_.model, 32, 21, 85);
  RgbdFrame frame;
  frame.colour = cv::Mat::zeros(32, 32, CV_8UC3);
  const auto set = [&](int row, int column, uchar value) {
    const int at = row * 85 + column;
    frame.colour.at<cv::Vec3b>(at % 1024 / 32, at % 32)[at / 1024] = value;
  };
  set(5, 4, 1);   // stride 8, cell (1, 1): centre (8, 8), size 8
  set(5, 5, 1);   // a person
  set(19, 0, 1);  // stride 16, cell (1, 1), and one to the right: centre (32, 16), size 16
  set(19, 4, 1);
  set(19, 5 + 56, 1);  // a chair
  const auto detector = make_yolox_detector(options_);
  for (int repeat = 0; repeat < 2; ++repeat) {
    const std::vector<Detection> found = detector->detect(frame);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].class_id, 0);
    EXPECT_EQ(found[0].box, cv::Rect2f(4, 4, 8, 8));
    EXPECT_EQ(found[1].class_id, 56);
    EXPECT_EQ(found[1].box, cv::Rect2f(24, 8, 8, 16));
    EXPECT_FLOAT_EQ(found[1].weight, 4.0F);
    EXPECT_FLOAT_EQ(found[1].score, 1.0F);
  }
}

TEST_P(YoloxBackends, TakesTheImageDealtOutByTwos) {
  // As above, but the network deals its image out first, whoever does it: its first 1024 numbers
  // are the four phases' blue, green and red, in the order of YOLOX's Focus.
  tiny_onnx::write_focus_model(options_.model, 32, 21, 85);
  RgbdFrame frame;
  frame.colour = cv::Mat::zeros(32, 32, CV_8UC3);
  const auto set = [&](int row, int column, uchar value) {
    const int at = row * 85 + column, channel = at / 256, phase = channel / 3;
    const int y = 2 * (at % 256 / 16) + phase % 2, x = 2 * (at % 16) + phase / 2;
    frame.colour.at<cv::Vec3b>(y, x)[channel % 3] = value;
  };
  set(5, 4, 1);  // upper left pixels: stride 8, cell (1, 1)
  set(5, 5, 1);
  set(10, 4, 1);  // lower left: stride 8, cell (2, 2)
  set(10, 5, 1);
  set(20, 4, 1);  // upper right: stride 32, cell (0, 0): all of the image
  set(20, 5 + 56, 1);
  const std::vector<Detection> found = make_yolox_detector(options_)->detect(frame);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].box, cv::Rect2f(4, 4, 8, 8));
  EXPECT_EQ(found[1].box, cv::Rect2f(12, 12, 8, 8));
  EXPECT_EQ(found[2].box, cv::Rect2f(0, 0, 16, 16));
  EXPECT_EQ(found[2].class_id, 56);
}

TEST_P(YoloxBackends, UsesAModelThatCannotBeCutAsItIs) {
  // Its shapes are among its weights: it takes a square, whatever the images are.
  tiny_onnx::write_model(options_.model, 64, 84, 85);
  RgbdFrame frame;
  frame.colour = cv::Mat::zeros(32, 64, CV_8UC3);
  const auto set = [&](int column, uchar value) {
    frame.colour.at<cv::Vec3b>(column / 64, column % 64)[0] = value;
  };
  set(4, 1);  // stride 8, cell (0, 0): centre (0, 0), size 8
  set(5, 1);  // a person
  const std::vector<Detection> found =
      make_yolox_detector(options_, frame.colour.size())->detect(frame);
  // The letterbox's grey is in the output, too, as scores far above 1.
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].box, cv::Rect2f(0, 0, 4, 4));
}

TEST_P(YoloxBackends, RefusesAModelOfAnotherShape) {
  tiny_onnx::write_model(options_.model, 32, 21, 84);
  EXPECT_THAT([&] { make_yolox_detector(options_); },
              ThrowsMessage<Error>(AllOf(HasSubstr("yolox_test.onnx"), HasSubstr("[1, 21, 84]"),
                                         HasSubstr("[1, 21, 85]"), Not(HasSubstr("\n")))));
}

TEST_P(YoloxBackends, RefusesAFileThatIsNoModel) {
  std::ofstream(options_.model) << "this is not a network";
  EXPECT_THAT([&] { make_yolox_detector(options_); },
              ThrowsMessage<Error>(AllOf(HasSubstr("yolox_test.onnx"), HasSubstr("not a model"),
                                         Not(HasSubstr("\n")))));
  std::ofstream(options_.model, std::ios::trunc).flush();
  EXPECT_THROW(make_yolox_detector(options_), Error);
}

TEST_P(YoloxBackends, RunsOnTheCpuWhenAProviderIsMissing) {
  tiny_onnx::write_model(options_.model, 32, 21, 85);
  options_.provider = "tensorrt";
  RgbdFrame frame;
  frame.colour = cv::Mat::zeros(32, 32, CV_8UC3);
  EXPECT_TRUE(make_yolox_detector(options_)->detect(frame).empty());
}

TEST_P(YoloxBackends, LooksAtFewerImagesWhereItSeesNobody) {
  tiny_onnx::write_model(options_.model, 32, 21, 85);
  const auto detector = make_yolox_detector(options_);
  RgbdFrame frame;
  frame.colour = cv::Mat::zeros(32, 32, CV_8UC3);
  int looks = 0;
  for (int i = 0; i < 90; ++i) {
    frame.timestamp = i / 30.0;
    if (!detector->looks_at(frame)) continue;
    detector->detect(frame);
    ++looks;
  }
  EXPECT_NEAR(looks, 30 + 30, 1);  // all of the first second, half of the others
}

TEST_P(YoloxBackends, RefusesAFrameWithoutColour) {
  tiny_onnx::write_model(options_.model, 32, 21, 85);
  const auto detector = make_yolox_detector(options_);
  EXPECT_THROW(detector->detect(RgbdFrame{}), Error);
}

TEST_P(YoloxBackends, FindsThePeopleInARealFrame) {
  const char* model = std::getenv("DKP_SLAM_MODEL");
  const char* data = std::getenv("DKP_SLAM_DATA");
  if (model == nullptr) GTEST_SKIP() << "DKP_SLAM_MODEL names no YOLOX model";
  if (data == nullptr) GTEST_SKIP() << "DKP_SLAM_DATA names no folder of sequences";
  const fs::path folder = fs::path(data) / "fr3_walking_halfsphere_50" / "rgb";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is missing";
  std::vector<fs::path> images(fs::directory_iterator(folder), fs::directory_iterator{});
  std::sort(images.begin(), images.end());
  RgbdFrame frame;
  frame.colour = testing::read_image(images.front());
  options_.model = model;
  const std::vector<Detection> found = make_yolox_detector(options_)->detect(frame);
  const auto people = std::count_if(found.begin(), found.end(), [](const Detection& d) {
    return d.class_id == 0 && d.score > 0.5F && d.box.height > 150.0F;
  });
  EXPECT_EQ(people, 2);

  // Cut to what the image fills it says the same, apart from the padding's share.
  const auto cut = make_yolox_detector(options_, frame.colour.size());
  const std::vector<Detection> same = cut->detect(frame);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_LT(i, same.size());
    EXPECT_EQ(same[i].class_id, found[i].class_id);
    EXPECT_NEAR(same[i].score, found[i].score, 0.03);
    EXPECT_GT((same[i].box & found[i].box).area(), 0.95F * (same[i].box | found[i].box).area());
  }
  // Images of another size are looked at all the same.
  cv::rotate(frame.colour, frame.colour, cv::ROTATE_90_CLOCKWISE);
  EXPECT_NO_THROW(cut->detect(frame));
}

INSTANTIATE_TEST_SUITE_P(Detection, YoloxBackends,
                         ::testing::Values(YoloxBackend::onnxruntime, YoloxBackend::opencv),
                         [](const auto& info) {
                           return info.param == YoloxBackend::opencv ? "OpenCv" : "OnnxRuntime";
                         });

TEST(YoloxDetector, MissingModelSaysWhereToGetOne) {
  YoloxOptions options;
  options.model = "no/such/yolox.onnx";
  EXPECT_THAT([&] { make_yolox_detector(options); },
              ThrowsMessage<Error>(
                  AllOf(HasSubstr("no/such/yolox.onnx"), HasSubstr("scripts/fetch_model.sh"))));
}

TEST(YoloxDetector, RefusesOptionsOutOfRange) {
  YoloxOptions options;
  options.model = fresh_folder() / "yolox_test.onnx";
  tiny_onnx::write_model(options.model, 32, 21, 85);
  options.threads = 0;
  EXPECT_THROW(make_yolox_detector(options), Error);
  options.threads = 1;
  options.decode.lowest_score = 1.5F;
  EXPECT_THROW(make_yolox_detector(options), Error);
}

#ifdef DKP_SLAM_HAVE_ONNXRUNTIME
TEST(YoloxDetector, RefusesAnUnknownProvider) {
  YoloxOptions options;
  options.model = fresh_folder() / "yolox_test.onnx";
  tiny_onnx::write_model(options.model, 32, 21, 85);
  options.provider = "abacus";
  EXPECT_THAT([&] { make_yolox_detector(options); }, ThrowsMessage<Error>(HasSubstr("abacus")));
}
#endif

/// Hides every model that the machine may hold.
class MakeDetector : public ::testing::Test {
 protected:
  MakeDetector() {
    camera_.fx = camera_.fy = 500.0;
    camera_.cx = 320.0;
    camera_.cy = 240.0;
    fs::current_path(folder_);
  }
  ~MakeDetector() override { fs::current_path(before_); }

  const fs::path folder_ = fresh_folder(), before_ = fs::current_path();
  const ScopedVariable variable_{"DKP_SLAM_MODEL", ""};
  const ScopedVariable cache_{"XDG_CACHE_HOME", folder_.string()};
  Camera camera_;
  DetectorOptions options_;
};

TEST_F(MakeDetector, AutomaticTakesYoloxWhereThereIsAModelElseMotion) {
  EXPECT_EQ(make_detector(options_, camera_)->name(), "motion");
  fs::create_directories("models");
  tiny_onnx::write_model("models/yolox_nano.onnx", 32, 21, 85);
  EXPECT_THAT(make_detector(options_, camera_)->name(), HasSubstr("yolox"));
  options_.kind = DetectorKind::motion;
  EXPECT_EQ(make_detector(options_, camera_)->name(), "motion");
  options_.kind = DetectorKind::none;
  EXPECT_EQ(make_detector(options_, camera_), nullptr);
}

TEST_F(MakeDetector, AModelThatIsAskedForMustBeThereAndWork) {
  options_.yolox.model = "gone.onnx";
  EXPECT_THROW(make_detector(options_, camera_), Error);
  std::ofstream("broken.onnx") << "x";
  options_.yolox.model = "broken.onnx";
  EXPECT_THROW(make_detector(options_, camera_), Error);
  options_.yolox.model.clear();
  options_.kind = DetectorKind::yolox;
  EXPECT_THAT([&] { make_detector(options_, camera_); },
              ThrowsMessage<Error>(HasSubstr("scripts/fetch_model.sh")));
}

TEST(FindModel, WantedFileComesFirstAndMustExist) {
  const fs::path folder = fresh_folder();
  const ScopedVariable variable("DKP_SLAM_MODEL", (folder / "other.onnx").string());
  std::ofstream(folder / "mine.onnx") << "x";
  EXPECT_EQ(find_model(folder / "mine.onnx"), folder / "mine.onnx");
  EXPECT_THAT([&] { find_model(folder / "gone.onnx"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("gone.onnx"), HasSubstr("fetch_model.sh"))));
}

TEST(FindModel, VariableComesNextAndMustNameAFile) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "mine.onnx") << "x";
  {
    const ScopedVariable variable("DKP_SLAM_MODEL", (folder / "mine.onnx").string());
    EXPECT_EQ(find_model(), folder / "mine.onnx");
  }
  const ScopedVariable variable("DKP_SLAM_MODEL", (folder / "gone.onnx").string());
  EXPECT_THAT([] { find_model(); }, ThrowsMessage<Error>(HasSubstr("DKP_SLAM_MODEL")));
}

TEST(FindModel, CacheHoldsTheSmallestSizeOrNothing) {
  const ScopedVariable variable("DKP_SLAM_MODEL", "");
  const fs::path folder = fresh_folder();
  const ScopedVariable cache("XDG_CACHE_HOME", folder.string());
  const fs::path before = fs::current_path();
  fs::current_path(folder);  // no models/ here
  EXPECT_FALSE(find_model());
  fs::create_directories(folder / "dkp-slam");
  std::ofstream(folder / "dkp-slam" / "yolox_s.onnx") << "x";
  std::ofstream(folder / "dkp-slam" / "yolox_tiny.onnx") << "x";
  EXPECT_EQ(find_model(), folder / "dkp-slam" / "yolox_tiny.onnx");
  fs::current_path(before);
}

}  // namespace
}  // namespace dkp_slam
