#include "dkp_slam/calibration/readout_check.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/calibration/test_sightings.h"

namespace dkp_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::World;

struct Mapped {
  Map map;
  Trajectory path;
};

constexpr double frame_rate = 30.0;
constexpr int frames_per_keyframe = 4;

/// A map of exact points in space from keyframes that a camera of the world's readout has seen,
/// made by a camera file that says `readout`. Its path is the true one.
Mapped mapped(const World& world, double readout) {
  Camera camera = testing::camera_of(world);
  camera.readout = readout;
  Mapped out{Map(camera, 1.2F, 8), {}};
  std::mt19937 random(world.seed);
  std::normal_distribution<double> normal;
  const std::vector<Eigen::Vector3d> points = testing::scattered_points(random);
  std::vector<int> landmarks(points.size(), -1);
  for (int i = 0; i < world.frames; ++i) {
    const double time = 100.0 + i / frame_rate;
    out.path.push_back({time, testing::pose_at(world, time)});
    if (i % frames_per_keyframe != 0) continue;
    std::vector<cv::Point2f> pixel;
    std::vector<float> depth;
    std::vector<std::size_t> seen;
    for (std::size_t k = 0; k < points.size(); ++k) {
      double z = 0.0;
      const Eigen::Vector2d at =
          testing::seen_pixel(world, testing::camera_of(world), points[k], time, world.readout, &z);
      if (at.x() < 10 || at.x() > 630 || at.y() < 10 || at.y() > 470) continue;
      pixel.emplace_back(float(at.x() + world.pixel_noise * normal(random)),
                         float(at.y() + world.pixel_noise * normal(random)));
      depth.push_back(float(z));
      seen.push_back(k);
    }
    Keyframe keyframe;
    keyframe.frame_index = i;
    keyframe.timestamp = time;
    keyframe.camera_from_world = out.path.back().world_from_camera.inverse();
    keyframe.features =
        FrameFeatures(camera, pixel, depth, std::vector<std::uint8_t>(seen.size(), 0),
                      std::vector<float>(seen.size(), 0.0F), std::vector<Descriptor>(seen.size()));
    constexpr double step = 1e-3;  // seconds
    const Se3 later = testing::pose_at(world, time + step);
    keyframe.features.correct_rolling_shutter(
        camera, (later.inverse() * out.path.back().world_from_camera).log() / step);
    keyframe.landmarks.assign(seen.size(), -1);
    const int id = out.map.add_keyframe(keyframe);
    for (std::size_t f = 0; f < seen.size(); ++f) {
      int& landmark = landmarks[seen[f]];
      if (landmark < 0) {
        landmark = out.map.add_landmark(points[seen[f]], id, int(f));
      } else {
        out.map.add_sighting(landmark, id, int(f));
      }
    }
  }
  return out;
}

ReadoutCheck checked(const World& world, double readout) {
  const Mapped m = mapped(world, readout);
  return check_readout(m.map, MeasurementModel(), m.path);
}

TEST(ReadoutCheck, FindsWhatTheFileSaysWrongly) {
  for (const double truth : {0.0, 0.02}) {
    World world;
    world.readout = truth;
    for (const double file : {0.0, 0.02}) {
      const ReadoutCheck check = checked(world, file);
      EXPECT_EQ(check.groups, 7);  // 45 keyframes
      EXPECT_NEAR(check.change, truth - file, 0.001) << truth << ' ' << file;
      EXPECT_LT(std::abs(check.change - (truth - file)), 5.0 * check.sigma + 0.0005);
    }
  }
}

/// Rows that see one after the other are then like landmarks that are a little sheared.
TEST(ReadoutCheck, ClaimsNothingOfAnEvenMotion) {
  World world;
  world.even = {0.1, 0.0, 0.0};
  Camera camera = testing::camera_of(world);
  camera.readout = 0.0;
  EXPECT_THAT(readout_warning(checked(world, 0.0), camera), IsEmpty());
}

TEST(ReadoutCheck, KnowsNothingOfAFewKeyframes) {
  World world;
  world.frames = 80;
  EXPECT_EQ(checked(world, 0.0).groups, 0);
}

TEST(ReadoutCheck, PassesOverKeyframesThatAreNotOnThePath) {
  Mapped m = mapped(World(), 0.0);
  for (StampedPose& pose : m.path) pose.timestamp += 1000.0;
  EXPECT_EQ(check_readout(m.map, MeasurementModel(), m.path).groups, 0);
}

TEST(ReadoutCheck, WarnsOfWhatIsLargeAndSure) {
  Camera camera;
  camera.readout = 0.005;
  EXPECT_THAT(readout_warning({}, camera), IsEmpty());
  EXPECT_THAT(readout_warning({0.007, 0.001, 9}, camera), IsEmpty());
  EXPECT_THAT(readout_warning({0.012, 0.003, 9}, camera), IsEmpty());
  EXPECT_THAT(readout_warning({0.012, 0.002, 9}, camera), HasSubstr("17 ms, not 5"));
  EXPECT_THAT(readout_warning({-0.012, 0.002, 9}, camera), HasSubstr("about 0 ms"));
  EXPECT_THAT(readout_warning({0.012, 0.002, 9}, camera), HasSubstr("dkp-slam calibrate"));
}

}  // namespace
}  // namespace dkp_slam
