#include "dkp_slam/geometry/planes/static_planes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/vga_camera.h"

namespace dkp_slam {
namespace {

constexpr float table_height = 0.6F;  // metres below the camera

Plane table(float below = table_height) { return {Eigen::Vector3f::UnitY(), below}; }

/// A table below the camera that ends `to_column`; beyond it, and above, a wall 3 m away.
DepthView view_of_table(int to_column, float below = table_height) {
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(3.0F));
  const Camera camera = testing::vga_camera();
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < to_column; ++u) {
      const double slope = camera.unproject({double(u), double(v)}, 1.0).y();
      if (slope > 0.0) depth.at<float>(v, u) = std::min(3.0F, below / static_cast<float>(slope));
    }
  }
  return make_depth_view(depth, depth_view_rays(camera));
}

/// Has found the table for long enough, at last at time 0.
StaticPlanes planes_with_table() {
  StaticPlanes known({}, {});
  known.update(view_of_table(640), {table()}, -1.0);
  known.update(view_of_table(640), {table()}, 0.0);
  return known;
}

TEST(StaticPlanes, WhatLiesInSomebodyMoreThanElsewhereIsNone) {
  // A flat surface 1 m away fills the view; a strip of it shows beside whoever is meant to be
  // there.
  const Camera camera = testing::vga_camera();
  const DepthView flat =
      make_depth_view(cv::Mat(480, 640, CV_32FC1, cv::Scalar(1.0F)), depth_view_rays(camera));
  cv::Mat most = cv::Mat::zeros(flat.depth.size(), CV_8UC1);
  most(cv::Rect(0, 0, 200, most.rows)) = 255;
  const auto planes_beside = [&](const cv::Mat& people) {
    PlaneOptions options;
    options.min_extent = options.min_width = 0.3;
    StaticPlanes known({}, options);
    known.look(flat, most, people, 0.0, 1);
    return known.planes().size();
  };
  EXPECT_EQ(planes_beside(most), 0U);
  EXPECT_EQ(planes_beside({}), 1U);  // boxes have room in them
}

TEST(StaticPlanes, WhatTheirHullsHoldIsOfTheRoomWhereItEndsAtPeople) {
  // Somebody 0.6 m away; in his hull, and a strip beside it, a board shows 1 m away.
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(0.0F));
  depth(cv::Rect(200, 0, 250, 480)) = 1.0;
  depth(cv::Rect(0, 0, 200, 480)) = 0.6;
  const DepthView view = make_depth_view(depth, depth_view_rays(testing::vga_camera()));
  cv::Mat silhouette = cv::Mat::zeros(view.depth.size(), CV_8UC1), hull = silhouette.clone();
  silhouette.colRange(0, 100) = 255;
  hull.colRange(0, 200) = 255;
  PlaneOptions options;
  options.min_extent = options.min_width = 0.3;
  StaticPlanes known({}, options);
  known.look(view, silhouette, hull, 0.0, 1);
  ASSERT_EQ(known.planes().size(), 1U);
  EXPECT_NEAR(std::abs(known.planes()[0].distance), 1.0, 0.01);
  // A silhouette that takes in a part of it: two backs side by side, of which one was missed.
  silhouette.colRange(0, 130) = 255;
  StaticPlanes others({}, options);
  others.look(view, silhouette, hull, 0.0, 1);
  EXPECT_EQ(others.planes().size(), 0U);
}

TEST(StaticPlanes, AtAStartWhatIsLargerThanPeopleIsOfTheRoomThoughSilhouettesHoldIt) {
  const DepthView wall = make_depth_view(cv::Mat(480, 640, CV_32FC1, cv::Scalar(1.4F)),
                                         depth_view_rays(testing::vga_camera()));
  cv::Mat silhouettes = cv::Mat::zeros(wall.depth.size(), CV_8UC1);
  silhouettes.colRange(0, 60) = 255;
  const cv::Mat hulls(wall.depth.size(), CV_8UC1, cv::Scalar(255));
  const auto walls_found_by = [&](StaticPlanes known) {
    known.look(wall, silhouettes, hulls, 0.05, 1);
    const std::vector<Plane> planes = known.planes();
    return std::count_if(planes.begin(), planes.end(),
                         [](const Plane& p) { return std::abs(p.normal.z()) > 0.9F; });
  };
  EXPECT_EQ(walls_found_by(StaticPlanes({}, {})), 1);
  EXPECT_EQ(walls_found_by(planes_with_table()), 0);
}

TEST(StaticPlanes, WhereABoxHidesAllWhatIsLargerThanAnybodyIsFound) {
  const Camera camera = testing::vga_camera();
  constexpr double away = 1.5;  // metres
  const auto found_of = [&](double width, StaticPlanes known) {
    cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(0.0F));
    depth(cv::Rect(100, 0, static_cast<int>(width / away * camera.fx), 480)) = away;
    const DepthView board = make_depth_view(depth, depth_view_rays(camera));
    known.look(board, cv::Mat(board.depth.size(), CV_8UC1, cv::Scalar(255)), {}, 0.1, 1);
    return known.planes();
  };
  const StaticPlanes nothing({}, {});
  ASSERT_EQ(found_of(1.0, nothing).size(), 1U);
  EXPECT_NEAR(found_of(1.0, nothing)[0].distance, away, 0.01);
  EXPECT_EQ(found_of(0.5, nothing).size(), 0U);  // as wide as a back
  // Where the room's planes are known nothing is sought among people: two side by side make one.
  StaticPlanes known = planes_with_table();
  known.update(view_of_table(640), {table()}, 0.05);
  EXPECT_EQ(found_of(1.0, known).size(), 0U);
}

TEST(StaticPlanes, WhereABoxHidesTheTableItIsFoundThoughAWallIsSeenBesideTheBox) {
  const Camera camera = testing::vga_camera();
  DepthView view = view_of_table(640);
  cv::Mat hidden = cv::Mat::zeros(view.depth.size(), CV_8UC1);
  constexpr int wall_rows = 50;  // of the view, 0.57 m of the wall; somebody's box hides the rest
  hidden(cv::Rect(0, wall_rows, hidden.cols, hidden.rows - wall_rows)) = 255;
  const int table_row = static_cast<int>(camera.cy + camera.fy * table_height / 3.0) / 2;
  view.depth(cv::Rect(0, wall_rows, hidden.cols, table_row - wall_rows)) = 0.0F;
  StaticPlanes known({}, {});
  known.look(view, hidden, {}, 0.0, 1);
  ASSERT_EQ(known.planes().size(), 2U);
  EXPECT_NEAR(std::abs(known.planes()[0].normal.z()), 1.0, 0.01) << "the wall";
  EXPECT_NEAR(std::abs(known.planes()[1].normal.y()), 1.0, 0.01) << "the table";
  EXPECT_NEAR(std::abs(known.planes()[1].distance), table_height, 0.01);
}

TEST(Planes, WhatRunsThroughTheCameraIsNone) {
  // Things at many depths along one row: a plane through the camera's centre holds them all.
  const Camera camera = testing::vga_camera();
  cv::Mat depth = cv::Mat::zeros(480, 640, CV_32FC1);
  for (int u = 0; u < depth.cols; ++u) {
    depth(cv::Rect(u, 232, 1, 17)) = 0.8 + 0.1 * (u * 7 % 13);
  }
  EXPECT_TRUE(fit_planes(make_depth_view(depth, depth_view_rays(camera)), {}, {}, 1).empty());
}

TEST(Planes, WhatCutsThroughThingsIsNone) {
  // The backs of chairs in a row that recedes: a plane runs through all of them, along none.
  cv::Mat depth = cv::Mat::zeros(480, 640, CV_32FC1);
  constexpr int backs = 8, wide = 40;  // pixels
  for (int k = 0; k < backs; ++k) {
    depth(cv::Rect(160 + wide * k, 0, wide, depth.rows)) = 1.0 / (1.1 - 0.1 * k);
  }
  const DepthView chairs = make_depth_view(depth, depth_view_rays(testing::vga_camera()));
  PlaneOptions options;
  options.max_planes = 1;
  EXPECT_TRUE(fit_planes(chairs, {}, options, 1).empty());
  options.min_along = 0.0;
  const std::vector<Plane> through = fit_planes(chairs, {}, options, 1);
  ASSERT_EQ(through.size(), 1U);
  EXPECT_GT(std::abs(through[0].normal.x()), 0.5F);
}

TEST(StaticPlanes, GoAlongWithTheCamera) {
  StaticPlanes known = planes_with_table();
  // The camera rises by 10 cm: what was 60 cm below is 70 cm below.
  Se3 motion;
  motion.translation = {0.0, 0.1, 0.0};
  known.move(motion);
  ASSERT_EQ(known.planes().size(), 1U);
  EXPECT_NEAR(known.planes()[0].distance, 0.7, 1e-6);
  // It rolls by a quarter turn: down is now to the left.
  Vector6d roll = Vector6d::Zero();
  roll[5] = 1.5707963267948966;
  known.move(Se3::exp(roll));
  EXPECT_NEAR(known.planes()[0].normal.x(), -1.0, 1e-5);
  EXPECT_NEAR(known.planes()[0].distance, 0.7, 1e-5);
}

TEST(StaticPlanes, AreRememberedWhileSomebodyHidesMostOfThem) {
  const DepthView corner = view_of_table(100);
  EXPECT_TRUE(fit_planes(corner, {}, {}, 1).size() <= 1U);  // the wall alone
  StaticPlanes known = planes_with_table();
  known.update(corner, {}, 1.0);
  ASSERT_EQ(known.planes().size(), 1U);
  EXPECT_TRUE(runs_along(corner, known.planes()[0], 20, 200, {}));
  EXPECT_FALSE(runs_along(corner, known.planes()[0], 200, 200, {}));
}

TEST(StaticPlanes, AreForgottenWhenNotSeenOrNotFoundForLong) {
  StaticPlanes known = planes_with_table();
  known.update(view_of_table(0), {}, 0.1);  // the wall is all there is
  EXPECT_TRUE(known.planes().empty());
  known = planes_with_table();
  known.update(view_of_table(640), {}, 1.9);
  EXPECT_EQ(known.planes().size(), 1U);
  known.update(view_of_table(640), {}, 2.1);
  EXPECT_TRUE(known.planes().empty());
}

TEST(StaticPlanes, WhatWasFlatForAMomentIsNotRemembered) {
  StaticPlanes known({}, {});
  known.update(view_of_table(640), {table()}, 0.0);
  EXPECT_EQ(known.planes().size(), 1U);
  known.update(view_of_table(640), {table()}, 0.4);
  known.update(view_of_table(640), {}, 0.5);
  EXPECT_TRUE(known.planes().empty());
  known.update(view_of_table(640), {table()}, 0.6);  // the third time, in the same place
  known.update(view_of_table(640), {}, 0.7);
  EXPECT_EQ(known.planes().size(), 1U);
}

TEST(StaticPlanes, WhatHasLongBeenThereIsSurerThanWhatIsNew) {
  const Plane back{Eigen::Vector3f::UnitZ(), 1.0F};
  StaticPlanes known({}, {});
  known.update(view_of_table(640), {back}, -1.5);
  EXPECT_EQ(known.surest().size(), 1U);  // nothing better is known
  known = planes_with_table();
  known.update(view_of_table(640), {table(), back}, 0.1);
  EXPECT_EQ(known.planes().size(), 2U);
  ASSERT_EQ(known.surest().size(), 1U);
  EXPECT_FLOAT_EQ(known.surest()[0].distance, table_height);
}

TEST(StaticPlanes, LargeOnesAreRememberedAlmostAtOnce) {
  Plane floor = table();
  floor.extent = 2.5F;
  floor.width = 1.2F;
  StaticPlanes known({}, {});
  known.update(view_of_table(640), {floor}, 0.0);
  known.update(view_of_table(640), {}, 0.03);  // once is chance
  EXPECT_TRUE(known.planes().empty());
  known.update(view_of_table(640), {table()}, 0.12);  // and need not look that large again
  known.update(view_of_table(640), {}, 0.15);
  EXPECT_EQ(known.planes().size(), 1U);
}

TEST(StaticPlanes, TakeTheNewerOfTwoThatAreOne) {
  StaticPlanes known = planes_with_table();
  const Plane again{-Eigen::Vector3f::UnitY(), -0.61F};  // the normal's sign means nothing
  known.update(view_of_table(640), {again}, 0.1);
  ASSERT_EQ(known.planes().size(), 1U);
  EXPECT_FLOAT_EQ(known.planes()[0].distance, -0.61F);
}

TEST(StaticPlanes, AdaptToWhatIsSeen) {
  StaticPlanes known = planes_with_table();
  known.update(view_of_table(200, 0.61F), {}, 0.1);  // a centimetre off, as after a poor motion
  ASSERT_EQ(known.planes().size(), 1U);
  EXPECT_NEAR(std::abs(known.planes()[0].distance), 0.61, 0.002);
}

}  // namespace
}  // namespace dkp_slam
