#include "dkp_slam/dynamics/masks/static_background.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

/// A wall 2 m away, textured grey 100, and what stands before it.
class StaticBackgroundTest : public ::testing::Test {
 protected:
  StaticBackgroundTest() {
    camera_.width = 320;
    camera_.height = 240;
    camera_.fx = camera_.fy = 260.0;
    camera_.cx = 160.0;
    camera_.cy = 120.0;
    rays_ = depth_view_rays(camera_);
    clear();
  }

  void clear() {
    depth_ = cv::Mat(240, 320, CV_32FC1, cv::Scalar(2.0));
    grey_ = cv::Mat(240, 320, CV_8UC1, cv::Scalar(100));
  }
  void put(const cv::Rect& where, float depth, int grey) {
    depth_(where) = depth;
    grey_(where) = grey;
  }
  DepthView view() const { return make_depth_view(depth_, rays_); }

  /// Shows what there is for some seconds, without anybody.
  void learn(StaticBackground& background, double from, double to,
             const std::vector<cv::Rect2f>& hidden = {}) {
    for (double t = from; t <= to; t += 1.0 / 30.0) {
      background.move(Se3());
      background.learn(view(), grey_, hidden, t);
    }
  }

  /// The object's mask in `box`, all of it, after correction: pixels of the image.
  cv::Mat corrected(StaticBackground& background, const cv::Rect& box) {
    background.move(Se3());
    ObjectMask mask;
    mask.area = view_rect(cv::Rect2f(box), rays_.size());
    mask.mask = cv::Mat(mask.area.size(), CV_8UC1, cv::Scalar(255));
    mask.mean_depth = 1.5F;
    background.correct(view(), grey_, cv::Rect2f(box), mask);
    cv::Mat painted = cv::Mat::zeros(240, 320, CV_8UC1);
    if (!mask.empty()) paint_object(mask, 255, painted);
    return painted;
  }

  static double share(const cv::Mat& mask, const cv::Rect& where) {
    return cv::countNonZero(mask(where)) / static_cast<double>(where.area());
  }

  Camera camera_;
  cv::Mat rays_, depth_, grey_;
};

const cv::Rect monitor(60, 60, 80, 60), person(150, 40, 70, 180), both(50, 30, 180, 200);

TEST_F(StaticBackgroundTest, GivesBackAMonitorAtAPersonsDepth) {
  StaticBackground background(camera_, StaticBackgroundOptions());
  put(monitor, 1.5F, 30);
  learn(background, 0.0, 1.0);
  put(person, 1.5F, 160);
  const cv::Mat mask = corrected(background, both);
  EXPECT_LT(share(mask, monitor), 0.01);
  EXPECT_GT(share(mask, person), 0.97);
}

TEST_F(StaticBackgroundTest, TellsWhichSurfacesStoodThere) {
  StaticBackground background(camera_, {});
  learn(background, 0.0, 1.0);
  background.move(Se3());
  put(cv::Rect(100, 60, 80, 120), 1.5F, 50);  // somebody, whom nobody told of
  const cv::Mat known = background.known(view(), grey_);
  ASSERT_EQ(known.size(), rays_.size());
  const int step = DepthView::step;
  EXPECT_EQ(cv::countNonZero(known(cv::Rect(100 / step, 60 / step, 80 / step, 120 / step))), 0);
  EXPECT_EQ(share(known, cv::Rect(200 / step, 20 / step, 80 / step, 200 / step)), 1.0);
}

TEST_F(StaticBackgroundTest, KnowsNothingAtFirstSight) {
  StaticBackground background(camera_, StaticBackgroundOptions());
  put(monitor, 1.5F, 30);
  learn(background, 0.0, 0.1);
  EXPECT_GT(share(corrected(background, both), monitor), 0.99);
}

TEST_F(StaticBackgroundTest, LearnsNothingInBoxes) {
  StaticBackground background(camera_, StaticBackgroundOptions());
  put(person, 1.5F, 160);
  learn(background, 0.0, 2.0, {cv::Rect2f(person)});
  EXPECT_GT(share(corrected(background, person), person), 0.99);
}

TEST_F(StaticBackgroundTest, AddsWhatIsInFrontInsideTheBox) {
  StaticBackground background(camera_, StaticBackgroundOptions());
  learn(background, 0.0, 1.0);
  put(person, 1.5F, 160);
  background.move(Se3());
  ObjectMask head;  // all that the clustering found
  head.area = cv::Rect(80, 20, 20, 20);
  head.mask = cv::Mat(head.area.size(), CV_8UC1, cv::Scalar(255));
  head.mean_depth = 1.5F;
  background.correct(view(), grey_, cv::Rect2f(person), head);
  cv::Mat painted = cv::Mat::zeros(240, 320, CV_8UC1);
  paint_object(head, 255, painted);
  EXPECT_GT(share(painted, person), 0.97);
  painted(person) = 0;
  EXPECT_LT(cv::countNonZero(painted), 400);
}

TEST_F(StaticBackgroundTest, ATouchIsNoReasonToCut) {
  // His back on the wall behind him: a narrow band of him lies in it.
  StaticBackground background(camera_, StaticBackgroundOptions());
  learn(background, 0.0, 1.0);
  put(person, 1.5F, 100);
  put(cv::Rect(person.x, person.y, person.width, 8), 1.99F, 100);
  EXPECT_GT(share(corrected(background, person), person), 0.95);
}

TEST_F(StaticBackgroundTest, AnotherBrightnessIsAnotherSurface) {
  StaticBackground background(camera_, StaticBackgroundOptions());
  put(monitor, 1.5F, 30);
  learn(background, 0.0, 1.0);
  put(monitor, 1.5F, 120);  // somebody stands where it was
  EXPECT_GT(share(corrected(background, both), monitor), 0.95);
}

TEST_F(StaticBackgroundTest, GoesAlongWithTheCamera) {
  StaticBackground background(camera_, StaticBackgroundOptions());
  put(monitor, 1.5F, 30);
  learn(background, 0.0, 1.0);
  // The camera moves right by 0.1 m: 17 pixels at 1.5 m, 13 at 2 m.
  clear();
  put(monitor - cv::Point(17, 0), 1.5F, 30);
  put(person, 1.5F, 160);
  background.move(Se3(Eigen::Quaterniond::Identity(), {-0.1, 0.0, 0.0}));
  const cv::Mat mask = corrected(background, both);
  EXPECT_LT(share(mask, monitor - cv::Point(17, 0)), 0.05);
  EXPECT_GT(share(mask, person), 0.95);
}

TEST_F(StaticBackgroundTest, WhatIsSeenThroughOrTooLongHiddenIsForgotten) {
  StaticBackgroundOptions options;
  options.memory = 2.0;
  const auto after = [&](const cv::Rect& hidden_by, float depth, double seconds) {
    StaticBackground background(camera_, options);
    clear();
    put(monitor, 1.5F, 30);
    learn(background, 0.0, 1.0);
    put(hidden_by, depth, 160);
    learn(background, 1.0, 1.0 + seconds, {cv::Rect2f(both)});
    put(monitor, 1.5F, 30);
    return share(corrected(background, both), monitor);
  };
  EXPECT_LT(after(monitor, 1.0F, 1.0), 0.01) << "hidden for a second";
  EXPECT_GT(after(monitor, 1.0F, 3.0), 0.99) << "hidden for too long";
  EXPECT_GT(after(monitor, 3.0F, 0.2), 0.95) << "seen through";
}

TEST_F(StaticBackgroundTest, ImagesWithoutDepthAreHarmless) {
  StaticBackground background(camera_, StaticBackgroundOptions());
  depth_ = 0.0F;
  learn(background, 0.0, 1.0);
  EXPECT_GT(share(corrected(background, both), both), 0.99);
  background.forget();
  EXPECT_GT(share(corrected(background, both), both), 0.99);
}

}  // namespace
}  // namespace dkp_slam
