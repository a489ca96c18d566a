#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/evaluation/relative_error.h"

namespace dkp_slam {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Agreement with the benchmark's own scripts that issue 2 asks for.
constexpr double tolerance = 1e-6;

/// A curved path, 100 poses a second for 4 s.
Trajectory path() {
  Trajectory poses;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.01 * i;
    Vector6d tangent;
    tangent << std::sin(t), std::cos(2.0 * t), 0.3 * t, 0.2 * t, std::sin(t), 0.4;
    poses.push_back({100.0 + t, Se3::exp(tangent)});
  }
  return poses;
}

Se3 some_motion() {
  Vector6d tangent;
  tangent << 3.0, -2.0, 1.0, 0.5, -1.0, 0.7;
  return Se3::exp(tangent);
}

/// Poses that stand still at the origin, without rotation, at these x.
Trajectory on_x_axis(const std::vector<double>& x) {
  Trajectory poses;
  for (std::size_t i = 0; i < x.size(); ++i) {
    poses.push_back({static_cast<double>(i),
                     Se3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(x[i], 0.0, 0.0))});
  }
  return poses;
}

/// Reads a test trajectory without the export room, which this room does not know.
Trajectory fixture(const std::string& name) {
  std::ifstream stream(std::string(DKP_SLAM_TEST_DATA) + "/" + name);
  Trajectory poses;
  std::string line;
  while (std::getline(stream, line)) {
    if (line.starts_with('#')) continue;
    std::istringstream fields(line);
    StampedPose pose;
    Se3& p = pose.world_from_camera;
    fields >> pose.timestamp >> p.translation.x() >> p.translation.y() >> p.translation.z() >>
        p.rotation.x() >> p.rotation.y() >> p.rotation.z() >> p.rotation.w();
    p.rotation.normalize();
    poses.push_back(pose);
  }
  return poses;
}

nlohmann::json reference() {
  std::ifstream stream(std::string(DKP_SLAM_TEST_DATA) + "/reference.json");
  return nlohmann::json::parse(stream);
}

void expect_same(const ErrorStatistics& ours, const nlohmann::json& theirs) {
  EXPECT_EQ(ours.count, theirs.at("pairs").get<std::size_t>());
  EXPECT_NEAR(ours.rmse, theirs.at("rmse"), tolerance);
  EXPECT_NEAR(ours.mean, theirs.at("mean"), tolerance);
  EXPECT_NEAR(ours.median, theirs.at("median"), tolerance);
  EXPECT_NEAR(ours.deviation, theirs.at("deviation"), tolerance);
  EXPECT_NEAR(ours.min, theirs.at("min"), tolerance);
  EXPECT_NEAR(ours.max, theirs.at("max"), tolerance);
}

StepUnit unit_named(const std::string& name) {
  for (StepUnit unit : {StepUnit::seconds, StepUnit::frames, StepUnit::metres, StepUnit::radians,
                        StepUnit::degrees}) {
    if (short_name(unit) == name) return unit;
  }
  throw Error("no such unit: " + name);
}

// reference.json holds what the benchmark's own scripts (evaluate_ate.py and evaluate_rpe.py of J.
// Sturm, ported to Python 3 without a change to what they compute) print for the two generated
// trajectories beside it: jittered stamps, a gap in the truth, lost frames, drift, another world
// frame, and an estimate that begins before the truth and ends after it.
TEST(AbsoluteError, AgreesWithTheBenchmarksScript) {
  const Trajectory truth = fixture("ground_truth.txt");
  const Trajectory estimate = fixture("estimate.txt");
  const nlohmann::json cases = reference().at("ate");
  ASSERT_GE(cases.size(), 5U);
  for (const nlohmann::json& expected : cases) {
    SCOPED_TRACE(expected.dump());
    const AbsoluteError error = absolute_error(
        truth, estimate,
        {.max_difference = expected.at("max_difference"), .offset = expected.at("offset")});
    expect_same(error.statistics, expected.at("error"));
    EXPECT_EQ(error.errors.size(), error.matches.size());
  }
}

TEST(RelativeError, AgreesWithTheBenchmarksScript) {
  const Trajectory truth = fixture("ground_truth.txt");
  const Trajectory estimate = fixture("estimate.txt");
  const nlohmann::json cases = reference().at("rpe");
  ASSERT_GE(cases.size(), 5U);
  for (const nlohmann::json& expected : cases) {
    SCOPED_TRACE(expected.dump());
    RelativeErrorOptions options;
    options.delta = expected.at("delta");
    options.unit = unit_named(expected.at("unit"));
    options.all_pairs = expected.at("all_pairs");
    options.offset = expected.at("offset");
    options.max_pairs = 0;
    const RelativeError error = relative_error(truth, estimate, options);
    expect_same(error.translation, expected.at("translation"));
    expect_same(error.rotation, expected.at("rotation"));
  }
}

TEST(AbsoluteError, AnotherWorldFrameIsNoError) {
  const Trajectory truth = path();
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate)
    pose.world_from_camera = some_motion() * pose.world_from_camera;
  const AbsoluteError error = absolute_error(truth, estimate);
  EXPECT_EQ(error.statistics.count, truth.size());
  EXPECT_LT(error.statistics.max, 1e-12);
  EXPECT_LT((error.truth_from_estimate * some_motion()).log().norm(), 1e-12);
}

TEST(AbsoluteError, DoesNotCorrectScale) {
  // The truth spans -3 to 3, the estimate twice that about the same middle: errors 3, 1, 1, 3.
  const AbsoluteError error =
      absolute_error(on_x_axis({-3.0, -1.0, 1.0, 3.0}), on_x_axis({-6.0, -2.0, 2.0, 6.0}));
  EXPECT_NEAR(error.statistics.rmse, std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(error.statistics.mean, 2.0, 1e-12);
  EXPECT_NEAR(error.statistics.median, 2.0, 1e-12);
  EXPECT_NEAR(error.statistics.deviation, 1.0, 1e-12);
  EXPECT_NEAR(error.statistics.min, 1.0, 1e-12);
  EXPECT_NEAR(error.statistics.max, 3.0, 1e-12);
}

TEST(AbsoluteError, DoesNotMirror) {
  const std::vector<Eigen::Vector3d> corners = {{3, 0, 0},  {-3, 0, 0}, {0, 2, 0},
                                                {0, -2, 0}, {0, 0, 1},  {0, 0, -1}};
  Trajectory truth;
  Trajectory mirrored;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double stamp = static_cast<double>(i);
    const Eigen::Vector3d image = corners[i].cwiseProduct(Eigen::Vector3d(1, 1, -1));
    truth.push_back({stamp, Se3(Eigen::Quaterniond::Identity(), corners[i])});
    mirrored.push_back({stamp, Se3(Eigen::Quaterniond::Identity(), some_motion() * image)});
  }
  // No rotation does better than undoing that motion: the two points on z stay 2 m off, the others
  // fit.
  const AbsoluteError error = absolute_error(truth, mirrored);
  EXPECT_NEAR(error.statistics.rmse, std::sqrt(8.0 / 6.0), 1e-12);
  EXPECT_LT((error.truth_from_estimate * some_motion()).log().norm(), 1e-12);
}

TEST(AbsoluteError, SaysWhichStampsEachHasWhenNoneMatch) {
  Trajectory late = path();
  for (StampedPose& pose : late) pose.timestamp += 1000.0;
  try {
    absolute_error(path(), late);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("100.000000 to 103.990000"),
                      HasSubstr("1100.000000 to 1103.990000"), HasSubstr("--offset")));
  }
  EXPECT_EQ(absolute_error(path(), late, {.offset = -1000.0}).statistics.count, 400U);
  EXPECT_THROW(absolute_error(path(), Trajectory(1)), Error);
  EXPECT_THROW(absolute_error(path(), Trajectory()), Error);
}

TEST(RelativeError, AnotherWorldFrameIsNoError) {
  const Trajectory truth = path();
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate)
    pose.world_from_camera = some_motion() * pose.world_from_camera;
  const RelativeError error = relative_error(truth, estimate);
  EXPECT_LT(error.translation.max, 1e-12);
  EXPECT_LT(error.rotation.max, 1e-7);
  // One pair per pose but those whose partner is past the end or the last pose itself.
  EXPECT_EQ(error.translation.count, 299U);
}

TEST(RelativeError, ConstantDriftGivesTheDriftOfOneStep) {
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 101; ++i) {
    const double t = 0.1 * i;
    truth.push_back({t, Se3()});
    estimate.push_back(
        {t, Se3(Eigen::Quaterniond(Eigen::AngleAxisd(0.02 * t, Eigen::Vector3d::UnitX())),
                Eigen::Vector3d(0.03 * t, 0.0, 0.0))});
  }
  for (const auto& [unit, delta, step_s] :
       {std::tuple(StepUnit::seconds, 1.0, 1.0), std::tuple(StepUnit::frames, 5.0, 0.5),
        std::tuple(StepUnit::metres, 0.06, 2.0), std::tuple(StepUnit::radians, 0.01, 0.5),
        std::tuple(StepUnit::degrees, 0.02 * 180.0 / M_PI, 1.0)}) {
    const RelativeError error = relative_error(truth, estimate, {.delta = delta, .unit = unit});
    EXPECT_NEAR(error.translation.min, 0.03 * step_s, 1e-9) << short_name(unit);
    EXPECT_NEAR(error.translation.max, 0.03 * step_s, 1e-9) << short_name(unit);
    EXPECT_NEAR(error.rotation.rmse, 0.02 * step_s, 1e-9) << short_name(unit);
  }
}

TEST(RelativeError, SamplesTheSamePairsForTheSameSeed) {
  const Trajectory truth = path();
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].world_from_camera.translation.x() += 1e-5 * static_cast<double>(i * i);
  }
  RelativeErrorOptions options{.all_pairs = true, .max_pairs = 500, .seed = 7};
  const RelativeError a = relative_error(truth, estimate, options);
  EXPECT_EQ(a.samples.size(), 500U);
  EXPECT_EQ(relative_error(truth, estimate, options).translation.rmse, a.translation.rmse);
  options.seed = 8;
  EXPECT_NE(relative_error(truth, estimate, options).translation.rmse, a.translation.rmse);
  const RelativeErrorOptions few{.delta = 0.1, .max_pairs = 50, .seed = 7};
  EXPECT_EQ(relative_error(truth, estimate, few).samples.size(), 50U);
}

TEST(RelativeError, NeedsTwoPairs) {
  EXPECT_THROW(relative_error(path(), path(), {.delta = 60.0}), Error);
  EXPECT_THROW(relative_error(path(), path(), {.delta = 0.0}), Error);
  EXPECT_THROW(relative_error(path(), Trajectory(1)), Error);
  EXPECT_THROW(relative_error(Trajectory(1), path()), Error);
  Trajectory late = path();
  for (StampedPose& pose : late) pose.timestamp += 1000.0;
  EXPECT_THROW(relative_error(path(), late), Error);
}

}  // namespace
}  // namespace dkp_slam
