#include "dkp_slam/system/self_check.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "dkp_slam/dynamics/frame_dynamics.h"
#include "dkp_slam/localization/frame.h"
#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/localization/test_world.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/pose_optimizer.h"

namespace dkp_slam {
namespace {

using testing::PointWorld;

/// Standard deviations in the worst direction: metres, radians.
struct Sigmas {
  double way = 0.0, angle = 0.0;
};

double worst_variance(const Eigen::Matrix3d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().maxCoeff();
}

/// The camera stands still. One keyframe makes the map; then all of its landmarks but a few are out
/// of sight, and another keyframe, which rests on those, makes new ones.
class HandedOn : public ::testing::Test {
 protected:
  HandedOn() {
    std::vector<int> shown;
    first_ = world_.frame_at({}, shown);
    features_ = shown.size();
    second_ = first_;
    world_.add_keyframe(map_, first_, shown);
    quality_of(self_check_, first_);
    by_first_ = handed_on(first_, {});
    for (std::size_t f = 0; f < few; ++f) second_.landmark[f] = first_.landmark[f];
    by_second_ = handed_on(second_, by_first_);
    world_.add_keyframe(map_, second_, shown);
    quality_of(self_check_, second_);
  }

  std::vector<PoseObservation> seen_by(const Frame& frame) const {
    std::vector<PoseObservation> seen;
    for (std::size_t f = 0; f < features_; ++f) {
      const int l = frame.landmark[f];
      if (l < 0) continue;
      seen.push_back({map_.landmark(l).position,
                      observation_of(frame.features, static_cast<int>(f), map_, model_)});
    }
    return seen;
  }
  static PoseQuality quality_of(SelfCheck& check, const Frame& frame) {
    return check.check(frame, true, frame.tracked_landmarks(), {});
  }
  /// What the frame's landmarks leave open, and beside that what they were handed themselves.
  Sigmas handed_on(const Frame& frame, const Sigmas& handed) const {
    const Matrix6d open = pose_information(map_.camera(), model_, {}, seen_by(frame)).inverse();
    return {
        std::sqrt(worst_variance(open.topLeftCorner<3, 3>()) + handed.way * handed.way),
        std::sqrt(worst_variance(open.bottomRightCorner<3, 3>()) + handed.angle * handed.angle)};
  }
  /// Beyond what it would be told if all keyframes were where they are for certain.
  void expect_doubt(const Frame& frame, const Sigmas& expected) {
    SelfCheck trusting(map_, model_);
    const Matrix6d doubt =
        quality_of(self_check_, frame).covariance - quality_of(trusting, frame).covariance;
    Vector6d variances;
    variances << Eigen::Vector3d::Constant(expected.way * expected.way),
        Eigen::Vector3d::Constant(expected.angle * expected.angle);
    EXPECT_LT((doubt - Matrix6d(variances.asDiagonal())).norm(), 1e-6 * variances.norm() + 1e-12);
  }

  /// A keyframe so long after the others that sees none of their landmarks.
  Frame carried(double seconds) {
    std::vector<int> shown;
    Frame frame = world_.frame_at({}, shown);
    frame.timestamp = seconds;
    world_.add_keyframe(map_, frame, shown);
    return frame;
  }

  static constexpr std::size_t few = 8;
  PointWorld world_{88};
  Map map_{world_.camera, 1.2F, 8};
  MeasurementModel model_;
  SelfCheck self_check_{map_, model_};
  std::size_t features_ = 0;
  Frame first_, second_;
  Sigmas by_first_, by_second_;
};

TEST_F(HandedOn, WhoSeesWhatADoubtfulKeyframeMadeIsAsDoubtful) {
  Frame frame = second_;
  for (std::size_t f = 0; f < few; ++f) frame.landmark[f] = -1;
  EXPECT_GT(by_second_.way, 3.0 * by_first_.way);
  expect_doubt(frame, by_second_);
}

TEST_F(HandedOn, LessSoWhereHalfAreOfTheFirst) {
  Frame frame = second_;
  for (std::size_t f = 0; f < few; ++f) frame.landmark[f] = -1;
  for (std::size_t f = few; f < few + (features_ - few) / 2; ++f) {
    frame.landmark[f] = first_.landmark[f];
  }
  expect_doubt(
      frame, {0.5 * (by_first_.way + by_second_.way), 0.5 * (by_first_.angle + by_second_.angle)});
}

TEST_F(HandedOn, WhatACarriedKeyframeMakesIsAsDoubtfulAsTheWayThere) {
  constexpr double seconds = 0.4, drift = 0.15;  // m/s and rad/s
  const Frame frame = carried(seconds);
  const double off = drift * seconds;
  expect_doubt(frame, {std::hypot(by_second_.way, off), std::hypot(by_second_.angle, off)});
}

TEST_F(HandedOn, AnotherMapIsDoubtedByNothing) {
  map_.start_map();
  expect_doubt(carried(0.4), {});
}

TEST_F(HandedOn, OfOneLandmarkNothingIsKnown) {
  Frame frame = second_;
  frame.landmark.assign(features_, -1);
  frame.landmark[few] = second_.landmark[few];
  const PoseQuality quality = quality_of(self_check_, frame);
  EXPECT_FALSE(quality.covariance.hasNaN());
  EXPECT_EQ(quality.covariance(0, 0), PoseQuality::unknown()(0, 0));
}

}  // namespace
}  // namespace dkp_slam
