#include "dkp_slam/calibration/adjustment.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/calibration/profile.h"

namespace dkp_slam {
namespace {

/// What is wrong with a camera, and how it moves.
struct World {
  double readout = 0.02, delay = 0.008, bias = 0.03;
  double pixel_noise = 0.5;
  double turn = 0.15, way = 0.10;  ///< amplitudes, radians and metres
  int frames = 180;
  unsigned seed = 1;
};

Camera camera_of(const World& world) {
  Camera camera;
  camera.fx = camera.fy = 525.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.readout = world.readout;
  return camera;
}

/// Turned to and fro and moved about, each freedom at its own pace.
Se3 pose_at(const World& world, double t) {
  const Eigen::Vector3d turn(std::sin(3.1 * t), std::sin(2.3 * t + 1.0), std::sin(1.7 * t + 2.0));
  const Eigen::Vector3d way(std::sin(1.3 * t), std::sin(1.9 * t + 0.5), std::sin(2.7 * t + 1.5));
  Vector6d tangent;
  tangent << world.way * way, world.turn * turn;
  return Se3::exp(tangent);
}

/// Where a point is seen by a camera whose rows are read one after the other.
Eigen::Vector2d seen_pixel(const World& world, const Camera& camera, const Eigen::Vector3d& point,
                           double time, double* depth) {
  double row = 0.0;
  Eigen::Vector2d pixel;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d p = pose_at(world, time + row * world.readout).inverse() * point;
    pixel = camera.project(p);
    row = pixel.y() / camera.height - 0.5;
    *depth = p.z();
  }
  return pixel;
}

/// Exact sightings of points in space with noise. The path is given as the true one, with errors.
std::vector<SightedFrame> frames_of(const World& world) {
  const Camera camera = camera_of(world);
  std::mt19937 random(world.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 200; ++i) {
    const double z = 2.0 + uniform(random);
    points.emplace_back(0.7 * z * uniform(random), 0.5 * z * uniform(random), z);
  }
  std::vector<SightedFrame> frames;
  for (int i = 0; i < world.frames; ++i) {
    SightedFrame frame;
    frame.time = 100.0 + i / 30.0;
    frame.depth_time = frame.time;
    Vector6d error;
    for (int k = 0; k < 6; ++k) error[k] = 0.002 * normal(random);
    frame.world_from_camera = pose_at(world, frame.time) * Se3::exp(error);
    for (std::size_t k = 0; k < points.size(); ++k) {
      double z = 0.0, later_z = 0.0;
      SeenLandmark seen;
      seen.landmark = static_cast<int>(k);
      seen.pixel = seen_pixel(world, camera, points[k], frame.time, &z);
      if (z < 0.3 || seen.pixel.x() < 10 || seen.pixel.x() > 630 || seen.pixel.y() < 10 ||
          seen.pixel.y() > 470) {
        continue;
      }
      // Each point lies on a surface that faces the camera.
      seen.depth.pixel = seen_pixel(world, camera, points[k], frame.time + world.delay, &later_z);
      const double noise = 0.3 * camera.depth_noise.sigma(later_z) * normal(random);
      seen.depth.inverse = 1.0 / (later_z - world.bias + noise);
      seen.pixel.x() += world.pixel_noise * normal(random);
      seen.pixel.y() += world.pixel_noise * normal(random);
      frame.sightings.push_back(seen);
    }
    frames.push_back(frame);
  }
  return frames;
}

ParameterChoice times_and_bias() {
  ParameterChoice free{};
  free[readout_parameter] = free[delay_parameter] = free[bias_parameter] = true;
  return free;
}

Adjustment adjusted(const World& world, Camera start, std::vector<Window>* windows = nullptr) {
  WindowOptions options;
  options.points = 50;
  options.least_points = 10;
  std::vector<Window> made = make_windows(frames_of(world), start, options);
  Adjustment found = adjust_windows(made, start, parameters_of(start), times_and_bias());
  if (windows) *windows = made;
  return found;
}

Camera without_readout(const World& world) {
  Camera camera = camera_of(world);
  camera.readout = 0.0;
  return camera;
}

TEST(Adjustment, FindsReadoutDelayAndBias) {
  const World world;
  const Adjustment found = adjusted(world, without_readout(world));
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.parameters[readout_parameter], world.readout, 6e-4);
  EXPECT_NEAR(found.parameters[delay_parameter], world.delay, 8e-4);
  EXPECT_NEAR(found.parameters[bias_parameter], world.bias, 6e-3);
  EXPECT_NEAR(found.noise.pixel, world.pixel_noise, 0.05);
  EXPECT_NEAR(found.noise.depth, 0.3, 0.05);
}

TEST(Adjustment, FindsThatNothingIsWrong) {
  World world;
  world.readout = world.delay = world.bias = 0.0;
  const Adjustment found = adjusted(world, without_readout(world));
  EXPECT_NEAR(found.parameters[readout_parameter], 0.0, 6e-4);
  EXPECT_NEAR(found.parameters[delay_parameter], 0.0, 8e-4);
  EXPECT_NEAR(found.parameters[bias_parameter], 0.0, 6e-3);
}

/// The errors of several worlds, over what each said of itself, must scatter by about one.
TEST(Adjustment, SaysHonestlyHowSureItIs) {
  Parameters squares = Parameters::Zero();
  constexpr int worlds = 4;
  for (unsigned seed = 1; seed <= worlds; ++seed) {
    World world;
    world.seed = seed;
    world.frames = 240;  // five pieces: of fewer more is told than is so
    const Adjustment found = adjusted(world, without_readout(world));
    Parameters truth = Parameters::Zero();
    truth[readout_parameter] = world.readout;
    truth[delay_parameter] = world.delay;
    for (int p : {readout_parameter, delay_parameter}) {
      const double error = found.parameters[p] - truth[p];
      squares[p] += error * error / found.covariance(p, p) / worlds;
    }
  }
  for (int p : {readout_parameter, delay_parameter}) {
    EXPECT_GT(std::sqrt(squares[p]), 0.3) << p;
    EXPECT_LT(std::sqrt(squares[p]), 2.0) << p;
  }
}

TEST(Adjustment, KnowsThatAStillCameraTellsNothing) {
  World world;
  world.turn = world.way = 0.0;
  const Adjustment found = adjusted(world, without_readout(world));
  EXPECT_GT(std::sqrt(found.covariance(readout_parameter, readout_parameter)), 0.002);
}

TEST(Adjustment, FindsTheFocalLength) {
  const World world;
  Camera start = without_readout(world);
  start.fx *= 1.02;
  start.fy *= 0.98;
  std::vector<Window> windows = make_windows(frames_of(world), start, {});
  ParameterChoice free = times_and_bias();
  free[fx_parameter] = free[fy_parameter] = true;
  const Adjustment found = adjust_windows(windows, start, parameters_of(start), free);
  EXPECT_NEAR(found.parameters[fx_parameter], 525.0, 1.5);
  EXPECT_NEAR(found.parameters[fy_parameter], 525.0, 1.5);
}

TEST(Profile, RowsLieOnALineOfTheReadout) {
  const World world;
  std::vector<Window> windows;
  const Adjustment found = adjusted(world, without_readout(world), &windows);
  for (const ProfileBin& bin : row_profile(windows, found.parameters))
    EXPECT_NEAR(bin.value, bin.at * world.readout, 1e-3 + 4.0 * bin.sigma);
}

TEST(Windows, NoneOfAHandfulOfFrames) {
  World world;
  world.frames = 8;
  EXPECT_TRUE(make_windows(frames_of(world), camera_of(world), {}).empty());
}

}  // namespace
}  // namespace dkp_slam
