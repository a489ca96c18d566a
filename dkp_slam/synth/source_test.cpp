#include "dkp_slam/synth/source.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/trajectory.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

/// A quarter of the usual width: quickly rendered.
SyntheticOptions small(const std::string& scenario, std::size_t frames) {
  SyntheticOptions o = synthetic_scenario(scenario);
  o.frames = frames;
  o.camera.width /= 4;
  o.camera.height /= 4;
  o.camera.fx /= 4.0;
  o.camera.fy /= 4.0;
  o.camera.cx /= 4.0;
  o.camera.cy /= 4.0;
  return o;
}

TEST(SyntheticSource, SameSeedSameBytesOnAnyNumberOfThreads) {
  SyntheticOptions o = small("walking_xyz", 3);
  o.seed = 5;
  o.camera.readout = 0.02;
  SyntheticSource a(o);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  SyntheticSource b(o);
  cv::setNumThreads(threads);
  int frames = 0;
  while (const auto frame = a.read()) {
    cv::setNumThreads(1);
    const auto again = b.read();
    cv::setNumThreads(threads);
    ASSERT_TRUE(again);
    EXPECT_EQ(frame->timestamp, again->timestamp);
    EXPECT_TRUE(same(frame->colour, again->colour));
    EXPECT_TRUE(same(frame->depth, again->depth));
    EXPECT_TRUE(same(a.truth().depth, b.truth().depth));
    EXPECT_TRUE(same(a.truth().instance, b.truth().instance));
    EXPECT_FALSE(a.truth().objects.empty());
    ++frames;
  }
  EXPECT_EQ(frames, 3);
  EXPECT_FALSE(b.read());
}

TEST(SyntheticSource, DepthHasRowsOfItsOwn) {
  SyntheticOptions o = small("walking_rpy", 5);
  o.kinect_noise = false;
  const auto last = [](const SyntheticOptions& options) {
    SyntheticSource source(options);
    std::optional<RgbdFrame> frame;
    while (auto next = source.read()) frame = std::move(next);
    return *frame;
  };
  const RgbdFrame at_once = last(o);
  o.camera.readout = 0.03;
  const RgbdFrame rolling = last(o);
  EXPECT_FALSE(same(rolling.depth, at_once.depth));
  o.camera.depth_readout = 0.0;
  const RgbdFrame both = last(o);
  EXPECT_TRUE(same(both.colour, rolling.colour));
  EXPECT_TRUE(same(both.depth, at_once.depth));
}

TEST(SyntheticSource, TruthIsOfOnePiece) {
  SyntheticOptions o = small("walking_static", 2);
  o.kinect_noise = false;
  SyntheticSource source(o);
  EXPECT_EQ(source.size(), 2U);
  const auto first = source.read();
  EXPECT_EQ(first->timestamp, 1000.0);
  EXPECT_EQ(first->colour.type(), CV_8UC3);
  EXPECT_EQ(first->depth.type(), CV_32FC1);
  EXPECT_TRUE(same(first->depth, source.truth().depth));
  const SyntheticTruth& truth = source.truth();
  const Se3 error = source.world_from_camera(first->timestamp).inverse() * truth.world_from_camera;
  EXPECT_LT(error.log().norm(), 1e-12);
  EXPECT_TRUE(same(truth.mask, truth.instance != 0));
  ASSERT_EQ(truth.objects.size(), 3U);  // two people and a box
  int pixels = 0;
  for (const SyntheticObject& object : truth.objects) {
    const cv::Mat of_it = truth.instance == object.instance;
    EXPECT_EQ(cv::countNonZero(of_it), object.pixels);
    EXPECT_EQ(cv::countNonZero(of_it(object.box)), object.pixels);
    // Tight: every border row and column of the box holds some of it.
    const cv::Mat in_box = of_it(object.box);
    EXPECT_GT(cv::countNonZero(in_box.row(0)), 0);
    EXPECT_GT(cv::countNonZero(in_box.row(in_box.rows - 1)), 0);
    EXPECT_GT(cv::countNonZero(in_box.col(0)), 0);
    EXPECT_GT(cv::countNonZero(in_box.col(in_box.cols - 1)), 0);
    EXPECT_EQ(object.class_name, object.instance <= 2 ? "person" : "");
    pixels += object.pixels;
  }
  EXPECT_EQ(cv::countNonZero(truth.mask), pixels);
  EXPECT_EQ(source.read()->timestamp, 1000.033333);
  EXPECT_FALSE(source.read());
}

/// Depth of one frame carried into another by the true poses agrees with what that one sees, but
/// where something moves or covers it.
TEST(SyntheticSource, DepthAndPosesAgreeOverTime) {
  SyntheticOptions o = small("walking_xyz", 31);
  o.kinect_noise = false;
  SyntheticSource source(o);
  source.read();
  const SyntheticTruth before = source.truth();
  const cv::Mat mask = before.mask.clone();
  for (int i = 0; i < 30; ++i) source.read();
  const SyntheticTruth& after = source.truth();
  EXPECT_TRUE(same(before.mask, mask));  // later frames are not written over it
  EXPECT_FALSE(same(after.mask, mask));
  const Se3 after_from_before = after.world_from_camera.inverse() * before.world_from_camera;
  EXPECT_GT(after_from_before.translation.norm(), 0.03);
  int compared = 0, equal = 0;
  for (int v = 0; v < o.camera.height; ++v) {
    for (int u = 0; u < o.camera.width; ++u) {
      if (before.mask.at<std::uint8_t>(v, u) != 0) continue;
      const Eigen::Vector3d point =
          after_from_before * o.camera.unproject({u, v}, before.depth.at<float>(v, u));
      const Eigen::Vector2d pixel = o.camera.project(point);
      const int x = cvRound(pixel.x()), y = cvRound(pixel.y());
      if (x < 0 || y < 0 || x >= o.camera.width || y >= o.camera.height) continue;
      if (after.mask.at<std::uint8_t>(y, x) != 0) continue;
      ++compared;
      // Half a pixel aside a slanted surface is up to some centimetres nearer or farther.
      if (std::abs(after.depth.at<float>(y, x) - point.z()) < 0.01 * point.z()) ++equal;
    }
  }
  EXPECT_GT(compared, 8000);
  EXPECT_GT(equal, 0.88 * compared);
}

TEST(SyntheticSource, NoiseDoesNotTouchTheTruth) {
  SyntheticOptions o = small("static_room", 1);
  SyntheticSource noisy(o);
  o.kinect_noise = false;
  SyntheticSource clean(o);
  const auto a = noisy.read(), b = clean.read();
  EXPECT_TRUE(same(noisy.truth().depth, clean.truth().depth));
  EXPECT_FALSE(same(a->depth, b->depth));
  EXPECT_FALSE(same(a->colour, b->colour));
  const double known = cv::countNonZero(a->depth > 0) / static_cast<double>(a->depth.total());
  EXPECT_GT(known, 0.6);
  EXPECT_LT(known, 0.99);
}

/// What the camera file says puts the depth images right again.
TEST(SyntheticSource, DepthIsOffAsAsked) {
  SyntheticOptions o = small("static_room", 1);
  o.kinect_noise = false;
  SyntheticSource exact(o);
  DepthCorrection& correction = o.camera.depth_correction;
  correction.bias = 0.05;
  correction.distortion.coefficients << 0.01, -0.005, 0.02, 0, 0, 0.003, 0, 0, 0.01;
  SyntheticSource off(o);
  const cv::Mat truth = exact.read()->depth;
  cv::Mat depth = off.read()->depth;
  EXPECT_GT(cv::norm(depth, truth, cv::NORM_INF), 0.1);
  DepthCorrector(correction, depth.size()).apply(depth);
  EXPECT_LT(cv::norm(depth, truth, cv::NORM_INF), 1e-4);
}

TEST(SyntheticSource, DropsFrames) {
  const SyntheticSource source(small("dropped_frames", 200));
  EXPECT_EQ(source.size(), 200U);
  double longest = 0.0;
  for (std::size_t i = 1; i < 200; ++i) {
    longest = std::max(longest, source.timestamp(i) - source.timestamp(i - 1));
  }
  EXPECT_GT(longest, 0.3);
  EXPECT_LT(longest, 1.1);
  EXPECT_NEAR(source.timestamp(29) - source.timestamp(0), 29.0 / 30.0, 1e-6);
}

TEST(SyntheticSource, BeginsLaterWhenAskedTo) {
  SyntheticOptions later = small("walking_xyz", 1);
  later.first_frame = 2;
  SyntheticSource whole(small("walking_xyz", 3)), part(later);
  const auto only = part.read();
  ASSERT_TRUE(only);
  EXPECT_FALSE(part.read());
  std::optional<RgbdFrame> last;
  while (auto frame = whole.read()) last = std::move(frame);
  EXPECT_EQ(only->index, 0);
  EXPECT_EQ(only->timestamp, last->timestamp);
  EXPECT_TRUE(same(only->depth, last->depth));
  EXPECT_TRUE(same(part.truth().instance, whole.truth().instance));
}

TEST(SyntheticSource, FollowsARecordedPathForAsLongAsItLasts) {
  const fs::path file = fs::path(::testing::TempDir()) / "source_path.txt";
  Trajectory poses;
  for (int i = 0; i <= 200; ++i) {
    poses.push_back({77.0 + 0.01 * i, Se3(camera_view(0.4, 0.0, 0.0), {0.001 * i, 0.0, 1.0})});
  }
  write_trajectory(file, poses);
  SyntheticOptions o = small("static_room", 0);
  o.trajectory = file;
  const SyntheticSource source(o);
  EXPECT_EQ(source.size(), 61U);
  const Se3 moved = source.world_from_camera(1000.5).inverse() * source.world_from_camera(1001.5);
  EXPECT_NEAR(moved.translation.norm(), 0.1, 1e-4);
  o.frames = 62;
  try {
    SyntheticSource too_long(o);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(file.string() + ": the path lasts 2.00 s"));
  }
  fs::remove(file);
  EXPECT_THROW(SyntheticSource gone(o), Error);
}

TEST(SyntheticSource, RefusesBadOptions) {
  SyntheticOptions o = small("static_room", 1);
  o.camera.fx = 0.0;
  EXPECT_THROW(SyntheticSource source(o), Error);
  EXPECT_THROW(synthetic_scenario("flying"), Error);
}

}  // namespace
}  // namespace dkp_slam
