#include "bench/results/measure.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/child_process.h"
#include "dkp_slam/evaluation/measure/fingerprint.h"
#include "dkp_slam/evaluation/measure/machine.h"
#include "tests/support/file_text.h"

namespace dkp_slam::bench {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using ::testing::HasSubstr;
using ::testing::Not;

bool go_on() { return false; }

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

/// A folder with a sequence "fr1_line" and, as the program, a shell script that writes what the
/// test put into the folder "answer" and says with which arguments it was called.
class MeasureRun : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fs::path("dkp_slam_results_test_" + unique_name());
    fs::remove_all(folder_);
    options_.data = folder_ / "data";
    options_.config = folder_ / "config";
    options_.cameras["fr1_line"] = "tum_fr1.yaml";
    options_.runs = folder_ / "runs";
    options_.program = folder_ / "program";
    options_.model = folder_ / "nano.onnx";
    // Ten seconds along x; the estimate is 1 m elsewhere, which the alignment takes away, and 20 mm
    // to the left or right of the truth in turn.
    std::string truth, estimate;
    for (int i = 0; i < 100; ++i) {
      const std::string time = std::to_string(100.0 + 0.1 * i), x = std::to_string(0.01 * i);
      truth += time + " " + x + " 0 0 0 0 0 1\n";
      estimate += time + " " + x + (i % 2 ? " 1.02" : " 0.98") + " 0 0 0 0 1\n";
    }
    write(options_.data / "fr1_line" / "groundtruth.txt", truth);
    write(folder_ / "answer" / "trajectory.txt", estimate);
    write(folder_ / "answer" / "summary.json",
          R"({"frames": 101, "skipped_frames": 2, "peak_memory_mb": 123.5})");
    write(folder_ / "answer" / "timings.csv",
          "features_ms,clustering_ms,removal_ms,tracking_ms,frame_ms\n1,2,3,4,30\n");
    set_program("while [ \"$1\" != --out ]; do shift; done; mkdir -p \"$2\"; cp '" +
                (folder_ / "answer").string() + "'/* \"$2\"");
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string unique_name() {
    return ::testing::UnitTest::GetInstance()->current_test_info()->name();
  }

  void set_program(const std::string& body) {
    write(options_.program,
          "#!/bin/sh\necho \"$@\" >> '" + (folder_ / "called").string() + "'\n" + body + "\n");
    fs::permissions(options_.program, fs::perms::owner_all);
  }

  fs::path folder_;
  MeasureOptions options_;
};

TEST_F(MeasureRun, FiguresComeFromTheOutputOfTheRun) {
  const RunKey key{"fr1_line", "dkp+", 7};
  ASSERT_TRUE(measure_run(options_, key, go_on));  // no run of seed 1 is there
  const std::string called = content(folder_ / "called");
  EXPECT_THAT(called, HasSubstr("--mode dkp+ --seed 7"));
  EXPECT_THAT(called, HasSubstr("config/tum_fr1.yaml"));
  EXPECT_THAT(called, HasSubstr("--detector yolox --model"));
  // Once more with what it detected, for the times without detection.
  EXPECT_THAT(called, HasSubstr("--one-at-a-time --detections " +
                                (run_folder(options_, key) / "out/detections.txt").string()));
  const RunFigures run = read_run(options_, key);
  EXPECT_EQ(run.problem, "");
  EXPECT_NEAR(run.ate_rmse, 0.02, 1e-4);
  EXPECT_EQ(run.frames, 103U);
  EXPECT_EQ(run.lost_frames, 3U);  // 100 poses
  EXPECT_EQ(run.peak_memory_mb, 123.5);
  EXPECT_EQ(run.without_detection_ms, 10.0);
  EXPECT_EQ(run.stage_ms.at("frame"), 30.0);
  ASSERT_TRUE(run.rpe_frame.has_value());
  EXPECT_NEAR(*run.rpe_frame, 0.04, 1e-4);
  EXPECT_GT(run.wall_s, 0.0);
}

TEST_F(MeasureRun, OtherSeedsReplayWhatTheFirstDetected) {
  const RunKey first{"fr1_line", "dkp+", 1}, second{"fr1_line", "dkp+", 2};
  ASSERT_TRUE(measure_run(options_, first, go_on));
  fs::remove(folder_ / "called");
  ASSERT_TRUE(measure_run(options_, second, go_on));
  const std::string called = content(folder_ / "called");
  EXPECT_THAT(called, Not(HasSubstr("--detector")));
  EXPECT_THAT(called, HasSubstr("--seed 2"));
  EXPECT_THAT(called, HasSubstr("--detections " +
                                (run_folder(options_, first) / "out/detections.txt").string()));
  EXPECT_TRUE(is_finished(options_, second));
  const RunFigures run = read_run(options_, second);
  EXPECT_EQ(run.problem, "");
  EXPECT_FALSE(run.whole);
  EXPECT_NEAR(run.ate_rmse, 0.02, 1e-4);
  EXPECT_EQ(run.lost_frames, 3U);
  Results results;
  results.runs = {read_run(options_, first), run};
  EXPECT_EQ(values(results, "fr1_line", "dkp+", Quantity::ate).size(), 2U);
  EXPECT_EQ(values(results, "fr1_line", "dkp+", Quantity::without_detection_ms).size(), 2U);
  EXPECT_EQ(values(results, "fr1_line", "dkp+", Quantity::peak_memory).size(), 1U);
  EXPECT_EQ(stage_values(results, "fr1_line", "dkp+", "frame").size(), 1U);
}

TEST_F(MeasureRun, AReplayThatGoesAnotherWayIsAProblem) {
  const RunKey key{"fr1_line", "dkp+", 1};
  ASSERT_TRUE(measure_run(options_, key, go_on));
  write(run_folder(options_, key) / "replay" / "trajectory.txt", "0 0 0 0 0 0 0 1\n");
  EXPECT_THAT(read_run(options_, key).problem, HasSubstr("another path"));
}

TEST_F(MeasureRun, ModeMasksIsGivenTheTrueMasks) {
  ASSERT_TRUE(measure_run(options_, {"fr1_line", "masks", 1}, go_on));
  const std::string called = content(folder_ / "called");
  const std::string masks = "--masks " + (options_.data / "fr1_line" / "mask").string();
  // The run, and its replay one frame at a time.
  EXPECT_NE(called.find(masks), called.rfind(masks));
  EXPECT_THAT(called, HasSubstr("--one-at-a-time"));
  EXPECT_THAT(called, Not(HasSubstr("--detect")));
}

TEST_F(MeasureRun, FinishedRunsAreKnownUntilSomethingChanges) {
  const RunKey key{"fr1_line", "off", 1};
  EXPECT_FALSE(is_finished(options_, key));
  ASSERT_TRUE(measure_run(options_, key, go_on));
  EXPECT_TRUE(is_finished(options_, key));
  EXPECT_FALSE(is_finished(options_, {"fr1_line", "off", 2}));
  MeasureOptions elsewhere = options_;
  elsewhere.config = folder_ / "other";
  EXPECT_FALSE(is_finished(elsewhere, key));
  set_program("exit 0");
  EXPECT_FALSE(is_finished(options_, key));
}

TEST_F(MeasureRun, AFailureIsKeptWithItsLastLine) {
  set_program("echo first >&2; echo 'camera is broken' >&2; exit 3");
  const RunKey key{"fr1_line", "off", 1};
  ASSERT_TRUE(measure_run(options_, key, go_on));
  EXPECT_TRUE(is_finished(options_, key));
  EXPECT_EQ(read_run(options_, key).problem, "exit code 3: camera is broken");
}

TEST_F(MeasureRun, AnInterruptedRunDoesNotCount) {
  set_program("trap 'echo saved; exit 0' INT; while :; do sleep 0.05; done");
  const RunKey key{"fr1_line", "off", 1};
  // Stops once the program runs and has set its trap.
  int polls = 0;
  EXPECT_FALSE(measure_run(options_, key, [&] { return ++polls > 100; }));
  EXPECT_FALSE(is_finished(options_, key));
  EXPECT_THAT(content(run_folder(options_, key) / "log.txt"), HasSubstr("saved"));
}

TEST_F(MeasureRun, DamagedOutputIsAProblemNotAnError) {
  write(folder_ / "answer" / "summary.json", "{");
  const RunKey key{"fr1_line", "off", 1};
  ASSERT_TRUE(measure_run(options_, key, go_on));
  EXPECT_THAT(read_run(options_, key).problem, HasSubstr("summary.json"));
}

TEST_F(MeasureRun, ExitBySignalIsNoSuccess) {
  set_program("kill -TERM $$");
  EXPECT_EQ(run_process({options_.program.string()}, folder_ / "log").exit_code, 128 + 15);
}

TEST_F(MeasureRun, AProgramThatCannotBeStartedIsAnError) {
  EXPECT_THROW(run_process({(folder_ / "nothing").string()}, folder_ / "log"), Error);
  EXPECT_THROW(fingerprint(folder_ / "nothing"), Error);
}

TEST(CameraFile, FollowsFromTheName) {
  EXPECT_EQ(camera_file("rgbd_dataset_freiburg1_xyz"), "tum_fr1.yaml");
  EXPECT_EQ(camera_file("rgbd_dataset_freiburg2_desk"), "tum_fr2.yaml");
  EXPECT_EQ(camera_file("rgbd_dataset_freiburg3_walking_halfsphere"), "tum_fr3.yaml");
  EXPECT_EQ(camera_file("rgbd_bonn_crowd"), "bonn.yaml");
}

TEST(CameraFile, IsNotGuessedFromOtherNames) {
  for (const char* name :
       {"fr1_xyz", "composite_xyz_walking", "my_fr1_room", "freiburg1_xyz", "bonn_crowd",
        "my_rgbd_bonn_crowd", "rgbd_dataset_freiburg4_x", "kitchen"}) {
    EXPECT_THROW(camera_file(name), Error) << name;
  }
}

TEST(CommandLine, IsQuotedAndHidesFolders) {
  EXPECT_EQ(command_line({"build/results", "--data", "/home/me/my data/", "--modes", "off,dkp+"}),
            "build/results --data 'DIR/my data' --modes off,dkp+");
  EXPECT_EQ(command_line({"a", "it's", ""}), "a 'it'\\''s' ''");
}

}  // namespace
}  // namespace dkp_slam::bench
