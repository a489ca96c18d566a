#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/test_command.h"
#include "apps/test_sequence.h"
#include "dkp_slam/export/images/image_file.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/stream/test_driver.h"
#include "dkp_slam/sensor/tum_lists.h"
#include "dkp_slam/sensor/tum_source.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using dkp_slam::testing::DriverConnection;
using dkp_slam::testing::frame_count;
using dkp_slam::testing::Program;
using dkp_slam::testing::WallSequence;
using ::testing::HasSubstr;

/// Records what real drivers send, by the program itself.
class RecordCommand : public testing::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    sequence_ = std::make_unique<WallSequence>(folder_ / "sequence", frame_count);
  }
  /// Every frame that is listed can be read and is the sequence's; returns how many there are.
  std::size_t frames_in(const fs::path& out) const {
    const auto recorded = open_tum_folder(out, sequence_->camera);
    const auto original = open_tum_folder(sequence_->folder(), sequence_->camera);
    std::size_t frames = 0;
    while (const auto frame = recorded->read()) {
      const auto expected = original->read();
      if (!expected) {
        ADD_FAILURE() << "more frames than there were";
        break;
      }
      EXPECT_EQ(frame->timestamp, expected->timestamp);
      EXPECT_NEAR(frame->depth_delay, expected->depth_delay, 1e-6);
      EXPECT_EQ(cv::norm(frame->colour, expected->colour, cv::NORM_INF), 0.0);
      EXPECT_EQ(cv::norm(frame->depth, expected->depth, cv::NORM_INF), 0.0);
      ++frames;
    }
    EXPECT_EQ(recorded->skipped(), 0U);
    // Nothing lies there that is not listed.
    for (const char* kind : {"rgb", "depth"}) {
      EXPECT_EQ(read_stamped_files(out / fmt::format("{}.txt", kind)).size(), frames);
      EXPECT_EQ(static_cast<std::size_t>(
                    std::distance(fs::directory_iterator(out / kind), fs::directory_iterator())),
                frames);
    }
    return frames;
  }

  std::unique_ptr<WallSequence> sequence_;
};

TEST_F(RecordCommand, AStreamBecomesTheFolderThatItWas) {
  ASSERT_EQ(bash("$P stream sequence 2>/dev/null | $P record - --out out 2>err >said"), 0) << err();
  EXPECT_EQ(frames_in(folder_ / "out"), frame_count);
  EXPECT_EQ(content(folder_ / "out/camera.yaml"), content(folder_ / "sequence/camera.yaml"));
  EXPECT_THAT(content(folder_ / "said"),
              HasSubstr("12 frames in out, 0.4 s at 30.0 Hz, 33 ms at most from one to the next; "
                        "0 dropped"));
  // The same path, to the byte.
  ASSERT_EQ(bash("$P run sequence --mode off --out a && $P run out --mode off --out b"), 0);
  EXPECT_EQ(content(folder_ / "a/trajectory.txt"), content(folder_ / "b/trajectory.txt"));
}

TEST_F(RecordCommand, TakesAFolderOrItsFirstFrames) {
  ASSERT_EQ(bash("$P record sequence --frames 5 --out out 2>err"), 0) << err();
  EXPECT_EQ(frames_in(folder_ / "out"), 5U);
  EXPECT_EQ(bash("$P record sequence --out out 2>err"), 1);
  EXPECT_THAT(err(), HasSubstr("out: is there already and not an empty folder"));
  EXPECT_EQ(bash("$P record --out other 2>err"), 2);
  EXPECT_EQ(frames_in(folder_ / "out"), 5U);
}

TEST_F(RecordCommand, MasksAreRecordedToo) {
  cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(0));
  mask.colRange(100, 200).setTo(255);
  fs::create_directory(folder_ / "masks");
  write_image(folder_ / "masks" / (WallSequence::stamp(3) + ".png"), mask);
  ASSERT_EQ(bash("$P stream sequence --masks masks 2>/dev/null | $P record - --out out 2>err"), 0);
  EXPECT_EQ(frames_in(folder_ / "out"), frame_count);
  const fs::path file = folder_ / "out/mask" / (WallSequence::stamp(3) + ".png");
  EXPECT_EQ(cv::norm(ImageReader().read_grey_png(file).image, mask, cv::NORM_INF), 0.0);
}

TEST_F(RecordCommand, CtrlCAndACutLeaveAWholeFolder) {
  ASSERT_EQ(bash("$P stream sequence >sequence.stream 2>err"), 0) << err();
  const std::string stream = content(folder_ / "sequence.stream");
  const std::string cut = stream.substr(0, stream.size() / 2);
  std::ofstream(folder_ / "cut.stream", std::ios::binary) << cut;
  EXPECT_EQ(bash("$P record - --out cut <cut.stream 2>err"), 1);
  EXPECT_THAT(err(), HasSubstr("(cut holds the 5 frames before)"));
  EXPECT_EQ(frames_in(folder_ / "cut"), 5U);

  const fs::path out = folder_ / "out";
  const std::string address = "unix:" + (folder_ / "s").string();
  const Program program = start({"record", "--source", address, "--out", out});
  DriverConnection driver(address);
  driver.send(cut);
  const auto images = [&] {
    std::error_code error;  // the folder is made when the stream begins
    return std::distance(fs::directory_iterator(out / "rgb", error), fs::directory_iterator());
  };
  for (int i = 0; i < 1000 && images() < 5; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  program.interrupt();
  EXPECT_EQ(program.wait(), 0) << program.err();
  EXPECT_EQ(frames_in(out), 5U);
}

TEST_F(RecordCommand, AFullDiskIsOneLineAndLeavesWhatWasThere) {
  // No file may get larger than 10 KB: the colour images do not fit.
  EXPECT_EQ(bash("$P stream sequence 2>/dev/null | (ulimit -f 10; $P record - --out out 2>&1 "
                 ">/dev/null | cat >err; exit ${PIPESTATUS[0]})"),
            1);
  EXPECT_THAT(err(), HasSubstr("cannot write; is the disk full? (out holds the 0 frames before)"));
  EXPECT_TRUE(fs::is_empty(folder_ / "out/rgb"));
  EXPECT_TRUE(fs::is_empty(folder_ / "out/depth"));
}

}  // namespace
}  // namespace dkp_slam
