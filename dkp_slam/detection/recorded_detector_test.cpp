#include "dkp_slam/detection/recorded_detector.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

class Recorded : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    file_ = fs::temp_directory_path() / fs::path(std::string("dkp_slam_recorded_") + test->name());
  }
  void TearDown() override { fs::remove(file_); }
  std::unique_ptr<Detector> open(const std::string& text) const {
    std::ofstream(file_) << text;
    return open_recorded_detections(file_, ClassTable());
  }
  std::string error_of(const std::string& text) const {
    try {
      open(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  static RgbdFrame frame_at(double timestamp) {
    RgbdFrame frame;
    frame.timestamp = timestamp;
    frame.colour = cv::Mat::zeros(480, 640, CV_8UC3);
    return frame;
  }

  fs::path file_;
};

TEST_F(Recorded, RepeatsWhatWasWritten) {
  Detection person;
  person.class_id = 0;
  person.score = 0.1F + 0.2F;
  person.box = {1.0F / 3.0F, 20.0F, 100.5F, 200.0F};
  Detection chair = person;
  chair.class_id = 56;
  const double time = 1305031102.175304;
  const auto detector = open(recorded_header() + recorded_lines(time, {person, chair}));
  const std::vector<Detection> back = detector->detect(frame_at(time));
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].box, person.box);
  EXPECT_EQ(back[0].score, person.score);
  EXPECT_EQ(back[0].weight, 10.0F);
  EXPECT_EQ(back[1].class_id, 56);
  EXPECT_EQ(back[1].weight, ClassTable().weight(56));
  EXPECT_TRUE(detector->detect(frame_at(time + 0.000002)).empty());
}

TEST_F(Recorded, NotLookedAtIsNotNobodyThere) {
  const auto detector = open(recorded_header() + "1.0 0 0.9 1 2 30 40\n" + recorded_gap(1.5) +
                             "# 2.0 a comment\n#\n");
  EXPECT_TRUE(detector->looks_at(frame_at(1.0)));
  EXPECT_FALSE(detector->looks_at(frame_at(1.5)));
  EXPECT_TRUE(detector->looks_at(frame_at(2.0)));
  EXPECT_TRUE(detector->detect(frame_at(2.0)).empty());
}

TEST_F(Recorded, ClipsBoxesToTheImage) {
  const auto detector = open("1.5 0 0.9 600 -10 100 50\n1.5 0 0.9 700 0 10 10\n");
  const std::vector<Detection> found = detector->detect(frame_at(1.5));
  ASSERT_EQ(found.size(), 1U);  // the second lies outside
  EXPECT_EQ(found[0].box, cv::Rect2f(600, 0, 40, 40));
}

TEST_F(Recorded, WrongLinesAreNamed) {
  EXPECT_NE(error_of("# ok\n1.0 0 0.9 1 2 3\n").find(":2: a line must hold"), std::string::npos);
  EXPECT_NE(error_of("1.0 0 0.9 1 2 3 4 5\n").find(":1: a line must hold"), std::string::npos);
  EXPECT_NE(error_of("1.0 person 0.9 1 2 3 4\n").find(":1: a line must hold"), std::string::npos);
  EXPECT_NE(error_of("1.0 80 0.9 1 2 3 4\n").find(":1: class 80"), std::string::npos);
  EXPECT_NE(error_of("1.0 0 1.5 1 2 3 4\n").find(":1: the score"), std::string::npos);
  EXPECT_NE(error_of("1.0 0 0.5 1 2 0 4\n").find(":1: the box"), std::string::npos);
  EXPECT_NE(error_of("1.0 0 nan 1 2 3 4\n").find(":1: "), std::string::npos);
}

TEST_F(Recorded, AMissingFileIsAnError) {
  EXPECT_THROW(open_recorded_detections(file_, ClassTable()), Error);
}

TEST_F(Recorded, APipeIsRefusedInsteadOfWaitedFor) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  try {
    open_recorded_detections(file_, ClassTable());
    ADD_FAILURE() << "opened";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("it is a pipe or a device"), std::string::npos);
  }
}

TEST_F(Recorded, AnEmptyFileDetectsNothing) {
  EXPECT_TRUE(open("")->detect(frame_at(1.0)).empty());
}

}  // namespace
}  // namespace dkp_slam
