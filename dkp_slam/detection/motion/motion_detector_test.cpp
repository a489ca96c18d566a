#include "dkp_slam/detection/motion/motion_detector.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/detection/motion/test_camera.h"
#include "dkp_slam/error.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "tests/support/image_files.h"

namespace dkp_slam {
namespace {

/// A smooth random pattern, fixed to the surface: grey at a place given in metres.
class Texture {
 public:
  explicit Texture(int seed) : pattern_(512, 512, CV_8UC1) {
    cv::RNG random(static_cast<std::uint64_t>(seed));
    random.fill(pattern_, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(pattern_, pattern_, {0, 0}, 1.5, 1.5, cv::BORDER_WRAP);
    cv::normalize(pattern_, pattern_, 20, 235, cv::NORM_MINMAX);
  }
  /// A texel is 3 cm, several pixels of the test camera; linear in between.
  float at(double x, double y) const {
    const double u = x / 0.03 + 5120.0, v = y / 0.03 + 5120.0;
    const int iu = static_cast<int>(std::floor(u)), iv = static_cast<int>(std::floor(v));
    const double a = u - iu, b = v - iv;
    const auto texel = [&](int s, int t) {
      return static_cast<double>(pattern_.at<uchar>(t & 511, s & 511));
    };
    return static_cast<float>((1 - b) * ((1 - a) * texel(iu, iv) + a * texel(iu + 1, iv)) +
                              b * ((1 - a) * texel(iu, iv + 1) + a * texel(iu + 1, iv + 1)));
  }

 private:
  cv::Mat pattern_;
};

/// A wall at 3 m that fills the image, a box front at 2.2 m that stands still, and a board at 1.5 m
/// that may move; all face the camera, which moves sideways. Truth is exact.
class World {
 public:
  struct Shot {
    RgbdFrame frame;
    cv::Mat board;  ///< CV_8UC1, 255 on the board
  };

  Shot shoot(int index, double camera_x, double board_x, bool with_board = true) const {
    const Camera camera = test_camera();
    Shot shot;
    shot.frame.index = index;
    shot.frame.timestamp = 100.0 + index / 30.0;
    shot.frame.colour.create(camera.height, camera.width, CV_8UC3);
    shot.frame.depth.create(camera.height, camera.width, CV_32FC1);
    shot.board = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const double rx = (u - camera.cx) / camera.fx, ry = (v - camera.cy) / camera.fy;
        float grey = 0.0F, z = 3.0F;
        const double bx = rx * 1.5 + camera_x - board_x, by = ry * 1.5;
        const double sx = rx * 2.2 + camera_x, sy = ry * 2.2;
        if (with_board && std::abs(bx) < 0.25 && std::abs(by) < 0.45) {
          grey = board_.at(bx, by);
          z = 1.5F;
          shot.board.at<uchar>(v, u) = 255;
        } else if (std::abs(sx - 0.7) < 0.25 && std::abs(sy - 0.3) < 0.3) {
          grey = still_.at(sx, sy);
          z = 2.2F;
        } else {
          grey = wall_.at(rx * 3.0 + camera_x, ry * 3.0);
        }
        shot.frame.colour.at<cv::Vec3b>(v, u) = cv::Vec3b::all(cv::saturate_cast<uchar>(grey));
        shot.frame.depth.at<float>(v, u) = z;
      }
    }
    return shot;
  }

 private:
  Texture wall_{1}, still_{2}, board_{3};
};

cv::Mat mask_of(const std::vector<Detection>& found, const cv::Size& size) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  for (const Detection& detection : found) {
    cv::Mat part = mask(cv::Rect(detection.box));
    part |= detection.mask;
  }
  return mask;
}

double share(const cv::Mat& part, const cv::Mat& whole) {
  return cv::countNonZero(part & whole) / static_cast<double>(cv::countNonZero(whole));
}

constexpr double camera_step = 0.008;  // metres a frame, a quarter of a metre a second

TEST(MotionDetector, SaysNothingOfAStillWorldSeenByAMovingCamera) {
  const World world;
  MotionDetector detector(test_camera());
  for (int i = 0; i < 25; ++i) {
    const World::Shot shot = world.shoot(i, camera_step * i, -0.2);
    EXPECT_TRUE(detector.detect(shot.frame).empty()) << "frame " << i;
  }
}

TEST(MotionDetector, FindsABoardThatMovesFromTheFirstFrameOn) {
  const World world;
  MotionDetector detector(test_camera());
  for (int i = 0; i < 25; ++i) {
    const World::Shot shot = world.shoot(i, camera_step * i, -0.4 + 0.035 * i);
    const std::vector<Detection> found = detector.detect(shot.frame);
    if (i < 10) continue;
    const cv::Mat mask = mask_of(found, shot.board.size());
    EXPECT_GT(share(mask, shot.board), 0.85) << "frame " << i;
    EXPECT_GT(share(shot.board, mask), 0.75) << "frame " << i;
  }
}

/// Somebody as round as people are, who fills two thirds of the view and bends sideways, `angle` in
/// radians. (Shifts alone would not do: a camera that turns as it moves could explain them.) Or as
/// flat as two backs side by side.
World::Shot behind_somebody(World::Shot shot, double angle, bool flat = false) {
  const Texture shirt(4);
  const cv::Size size = shot.board.size();
  const int left = size.width / 6, width = size.width - 2 * left;
  for (int v = 0; v < size.height; ++v) {
    for (int u = left; u < left + width; ++u) {
      const double x = 0.006 * (u - size.width / 2), y = 0.006 * (v - size.height / 2);
      const float grey = shirt.at(std::cos(angle) * x - std::sin(angle) * y,
                                  std::sin(angle) * x + std::cos(angle) * y);
      const double bulge = flat ? -0.5 : 0.15 * std::sin(CV_PI * (u - left) / width);
      shot.frame.colour.at<cv::Vec3b>(v, u) = cv::Vec3b::all(cv::saturate_cast<uchar>(grey));
      shot.frame.depth.at<float>(v, u) = static_cast<float>(0.8 - bulge);
      shot.board.at<uchar>(v, u) = 255;
    }
  }
  return shot;
}

TEST(MotionDetector, ALargePlaneIsTheRoomThoughSomebodyFillsTheViewFromTheFirstFrameOn) {
  const World world;
  MotionDetectorOptions without;
  without.planes.max_planes = 0;
  MotionDetector detector(test_camera()), blind(test_camera(), without);
  for (int i = 0; i < 20; ++i) {
    const World::Shot shot = behind_somebody(world.shoot(i, camera_step * i, 0.0, false), 0.02 * i);
    const cv::Mat found = mask_of(detector.detect(shot.frame), shot.board.size());
    const cv::Mat misled = mask_of(blind.detect(shot.frame), shot.board.size());
    if (i < 10) continue;
    EXPECT_GT(share(found, shot.board), 0.65) << "frame " << i;  // his middle does not move
    EXPECT_LT(share(found, ~shot.board), 0.1) << "frame " << i;
    EXPECT_LT(share(misled, shot.board), 0.5) << "frame " << i;
  }
}

/// Who stood still, round, turns flat and bends: a plane twice as large as the wall beside it. With
/// `blank`, the frame in which he does so shows no corner to follow, before it nor after.
void expect_the_plane_that_was_there(bool blank) {
  const World world;
  MotionDetectorOptions forgetful;
  forgetful.static_planes.proof = forgetful.static_planes.large_proof = 1e9;
  MotionDetector detector(test_camera()), misled(test_camera(), forgetful);
  constexpr int still = 20;  // frames
  for (int i = 0; i < still + 15; ++i) {
    const double angle = 0.02 * std::max(0, i - still);
    World::Shot shot = behind_somebody(world.shoot(i, 0.0, 0.0, false), angle, i >= still);
    if (blank && i == still) shot.frame.colour.setTo(0);
    const cv::Mat found = mask_of(detector.detect(shot.frame), shot.board.size());
    const cv::Mat less = mask_of(misled.detect(shot.frame), shot.board.size());
    if (i < still + (blank ? 11 : 10)) continue;
    EXPECT_GT(share(found, shot.board), 0.6) << "frame " << i;  // his middle does not move
    EXPECT_LT(share(found, ~shot.board), 0.05) << "frame " << i;
    EXPECT_LT(share(less, shot.board), 0.1) << "frame " << i;
  }
}

TEST(MotionDetector, ThePlaneThatWasThereIsTheRoomAndNotTwoBacks) {
  expect_the_plane_that_was_there(false);
}

TEST(MotionDetector, ThePlaneThatWasThereIsTheRoomAlsoAfterAFrameThatShowsNoMotion) {
  expect_the_plane_that_was_there(true);
}

TEST(MotionDetector, WhoMovedIsStillThereInAFrameThatShowsNoMotion) {
  const World world;
  MotionDetector detector(test_camera());
  for (int i = 0; i < 20; ++i) {
    World::Shot shot = world.shoot(i, camera_step * i, -0.4 + 0.035 * i);
    if (i == 14) shot.frame.colour.setTo(0);  // no corner to follow, before it nor after
    const cv::Mat mask = mask_of(detector.detect(shot.frame), shot.board.size());
    if (i < 10) continue;
    EXPECT_GT(share(mask, shot.board), 0.6) << "frame " << i;
    EXPECT_GT(share(shot.board, mask), 0.6) << "frame " << i;
  }
}

TEST(MotionDetector, FindsWhatComesInBeforeAStillCamera) {
  const World world;
  MotionDetector detector(test_camera());
  for (int i = 0; i < 30; ++i) {
    const World::Shot shot = world.shoot(i, 0.0, -1.4 + 0.05 * i);
    const std::vector<Detection> found = detector.detect(shot.frame);
    if (cv::countNonZero(shot.board) < 0.1 * shot.board.total()) continue;
    const cv::Mat mask = mask_of(found, shot.board.size());
    EXPECT_GT(share(mask, shot.board), 0.8) << "frame " << i;
    EXPECT_GT(share(shot.board, mask), 0.8) << "frame " << i;
  }
}

/// The frame .12 s ago did not show the places where he is now.
TEST(MotionDetector, FindsWhoComesTowardsACameraThatMovesTowardsHim) {
  const World world;
  MotionDetector detector(test_camera());
  int asked = 0;
  for (int i = 0; i < 40; ++i) {
    const World::Shot shot = world.shoot(i, 0.04 * i, 2.4 - 0.02 * i);
    const cv::Mat mask = mask_of(detector.detect(shot.frame), shot.board.size());
    const double view = cv::countNonZero(shot.board) / static_cast<double>(shot.board.total());
    if (view < 0.04) continue;
    ++asked;
    EXPECT_GT(share(mask, shot.board), 0.6) << "frame " << i << ", " << view << " of the view";
    EXPECT_LT(share(mask, ~shot.board), 0.1) << "frame " << i;
  }
  EXPECT_GT(asked, 10);
}

TEST(MotionDetector, DescribesWhatItFinds) {
  const World world;
  MotionDetector detector(test_camera());
  std::vector<Detection> found;
  World::Shot shot;
  for (int i = 0; i < 20; ++i) {
    shot = world.shoot(i, 0.0, -0.5 + 0.04 * i);
    found = detector.detect(shot.frame);
  }
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].class_id, Detection::motion_class);
  EXPECT_EQ(found[0].weight, 10.0F);
  EXPECT_GT(found[0].score, 0.8F);
  EXPECT_LE(found[0].score, 1.0F);
  EXPECT_EQ(found[0].mask.size(), cv::Rect(found[0].box).size());
  EXPECT_EQ(found[0].mask.type(), CV_8UC1);
  const cv::Rect truth = cv::boundingRect(shot.board);
  const cv::Rect box(found[0].box);
  EXPECT_GT((box & truth).area(), 0.8 * (box | truth).area());
}

TEST(MotionDetector, TakesInWhatCameAndStoodStillForAWhile) {
  const World world;
  MotionDetectorOptions options;
  options.absorb_after = 0.5;
  options.memory = 0.3;
  MotionDetector detector(test_camera(), options);
  for (int i = 0; i < 10; ++i) detector.detect(world.shoot(i, 0.0, 0.0, false).frame);
  // Free space was seen there and the picture has changed: one frame that says both is enough.
  for (int i = 10; i < 20; ++i)
    EXPECT_FALSE(detector.detect(world.shoot(i, 0.0, -0.2).frame).empty()) << "frame " << i;
  std::vector<Detection> found;
  for (int i = 20; i < 50; ++i) found = detector.detect(world.shoot(i, 0.0, -0.2).frame);
  EXPECT_TRUE(found.empty());
}

TEST(MotionDetector, StartsAnewAfterAGapAndRepeatsItself) {
  const World world;
  MotionDetector first(test_camera()), second(test_camera());
  for (int i = 0; i < 15; ++i) {
    const World::Shot shot = world.shoot(i, camera_step * i, -0.4 + 0.04 * i);
    const std::vector<Detection> a = first.detect(shot.frame), b = second.detect(shot.frame);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].box, b[k].box);
      EXPECT_EQ(a[k].score, b[k].score);
      EXPECT_EQ(cv::norm(a[k].mask, b[k].mask, cv::NORM_INF), 0.0);
    }
  }
  World::Shot later = world.shoot(15, 0.1, 0.3);
  later.frame.timestamp += 10.0;
  EXPECT_TRUE(first.detect(later.frame).empty());
  later.frame.timestamp -= 5.0;
  EXPECT_TRUE(first.detect(later.frame).empty());
}

TEST(MotionDetector, SurvivesFramesWithoutDepthOrContent) {
  const World world;
  MotionDetector detector(test_camera());
  World::Shot shot = world.shoot(0, 0.0, 0.0);
  const cv::Mat depth = shot.frame.depth.clone();
  for (int i = 0; i < 6; ++i) {
    shot.frame.timestamp += 1.0 / 30.0;
    shot.frame.depth = i % 2 == 0 ? depth : cv::Mat::zeros(depth.size(), CV_32FC1);
    EXPECT_TRUE(detector.detect(shot.frame).empty());
  }
  shot.frame.colour.setTo(0);
  shot.frame.timestamp += 1.0 / 30.0;
  EXPECT_TRUE(detector.detect(shot.frame).empty());
}

TEST(MotionDetector, FindsWalkingPeopleInARealSequence) {
  const char* data = std::getenv("DKP_SLAM_DATA");
  if (data == nullptr) GTEST_SKIP() << "DKP_SLAM_DATA names no folder of sequences";
  const std::filesystem::path folder = std::filesystem::path(data) / "composite_xyz_walking";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is missing";
  const Camera camera = load_camera(DKP_SLAM_SOURCE_DIR "/config/tum_fr1.yaml");
  TumOptions options;
  options.frame_limit = 100;
  const auto source = open_tum_folder(folder.string(), camera, options);
  std::vector<std::filesystem::path> truths(std::filesystem::directory_iterator(folder / "mask"),
                                            std::filesystem::directory_iterator{});
  std::sort(truths.begin(), truths.end());
  MotionDetector detector(camera);
  double common = 0.0, found = 0.0, true_area = 0.0;
  while (const auto frame = source->read()) {
    const cv::Mat mask = mask_of(detector.detect(*frame), frame->colour.size());
    const cv::Mat truth = testing::read_image(truths.at(frame->index));
    common += cv::countNonZero(mask & truth);
    found += cv::countNonZero(mask);
    true_area += cv::countNonZero(truth);
  }
  EXPECT_GT(common / true_area, 0.8);  // 0.91 and 0.90 when written
  EXPECT_GT(common / found, 0.75);
}

TEST(MotionDetector, RefusesBadInput) {
  Camera camera = test_camera();
  camera.fx = 0.0;
  EXPECT_THROW(MotionDetector{camera}, Error);
  MotionDetector detector(test_camera());
  RgbdFrame frame;
  EXPECT_THROW(detector.detect(frame), Error);
  frame.colour = cv::Mat::zeros(240, 320, CV_8UC3);
  frame.depth = cv::Mat::zeros(240, 320, CV_16UC1);
  EXPECT_THROW(detector.detect(frame), Error);
}

}  // namespace
}  // namespace dkp_slam
