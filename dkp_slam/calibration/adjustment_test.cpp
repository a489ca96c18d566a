#include "dkp_slam/calibration/adjustment.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/calibration/profile.h"
#include "dkp_slam/calibration/test_sightings.h"

namespace dkp_slam {
namespace {

using testing::camera_of;
using testing::frames_of;
using testing::World;

ParameterChoice times_and_bias() {
  ParameterChoice free{};
  free[readout_parameter] = free[delay_parameter] = free[bias_parameter] = true;
  return free;
}

Adjustment adjusted(const World& world, Camera start, std::vector<Window>* windows = nullptr,
                    const ParameterChoice& free = times_and_bias()) {
  WindowOptions options;
  options.points = 50;
  options.least_points = 10;
  std::vector<Window> made = make_windows(frames_of(world), start, options);
  Adjustment found = adjust_windows(made, start, parameters_of(start), free);
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

TEST(Adjustment, FindsTheSameWithDepthOfOneMoment) {
  World world;
  world.depth_readout = 0.0;
  world.turn = 0.3;
  const Adjustment found = adjusted(world, without_readout(world));
  EXPECT_NEAR(found.parameters[readout_parameter], world.readout, 6e-4);
  EXPECT_NEAR(found.parameters[delay_parameter], world.delay, 8e-4);
  EXPECT_NEAR(found.noise.depth, 0.3, 0.05);
  Camera as_colour = without_readout(world);
  as_colour.depth_readout.reset();
  EXPECT_GT(adjusted(world, as_colour).noise.depth, 1.1 * found.noise.depth)
      << "as if it were read as colour is";
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

/// Every row sees what the middle one sees, only later: as if the landmarks were elsewhere.
TEST(Adjustment, KnowsThatAnEvenlyTranslatedCameraTellsNothing) {
  World world;
  world.even = {0.2, 0.05, 0.1};
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

Adjustment adjusted_principal_point(const World& world, double cx, double cy) {
  Camera start = without_readout(world);
  start.cx += cx;
  start.cy += cy;
  ParameterChoice free = times_and_bias();
  free[cx_parameter] = free[cy_parameter] = true;
  return adjusted(world, start, nullptr, free);
}

TEST(Adjustment, FindsThePrincipalPoint) {
  const World world;
  const Camera truth = camera_of(world);
  const Adjustment found = adjusted_principal_point(world, 6.0, -4.0);
  EXPECT_NEAR(found.parameters[cx_parameter], truth.cx, 1.0);
  EXPECT_NEAR(found.parameters[cy_parameter], truth.cy, 1.0);
}

/// Moved to and fro without a turn, another principal point is a world a little sheared.
TEST(Adjustment, KnowsThatACameraThatDoesNotTurnHidesThePrincipalPoint) {
  World world;
  world.turn = 0.0;
  const Adjustment found = adjusted_principal_point(world, 6.0, -4.0);
  EXPECT_GT(std::sqrt(found.covariance(cx_parameter, cx_parameter)), 1.5);
  EXPECT_GT(std::sqrt(found.covariance(cy_parameter, cy_parameter)), 1.5);
}

TEST(Adjustment, FindsTheDepthDistortion) {
  World world;
  world.frames = 240;
  world.distortion.coefficients << -0.005, 0.002, 0.006, 0.001, -0.002, 0.002, 0.003, 0.001, -0.001;
  ParameterChoice free = times_and_bias();
  for (int i = 0; i < DepthDistortion::size; ++i)
    free[static_cast<std::size_t>(depth_distortion_parameter + i)] = true;
  const Adjustment found = adjusted(world, without_readout(world), nullptr, free);
  EXPECT_NEAR(found.parameters[bias_parameter], world.bias, 6e-3);
  for (int i = 0; i < DepthDistortion::size; ++i) {
    const int p = depth_distortion_parameter + i;
    const double sigma = std::sqrt(found.covariance(p, p));
    EXPECT_LT(sigma, 1e-3) << i;
    EXPECT_NEAR(found.parameters[p], world.distortion.coefficients[i], 1e-3) << i;
  }
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
