#include "dkp_slam/evaluation/report/charts.h"

#include <cmath>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/evaluation/report/test_markup.h"

namespace dkp_slam {
namespace {

using dkp_slam::testing::MarkupCheck;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr Colour red{250, 1, 2}, blue{3, 4, 250};
const ChartBox box{{0.0, 0.0}, {540.0, 430.0}};

/// A circle at the height of a camera, with errors of this size across it.
Trajectory circle(double error, std::size_t poses = 100) {
  Trajectory path;
  for (std::size_t i = 0; i < poses; ++i) {
    const double angle = 0.06 * static_cast<double>(i);
    const double radius = 1.0 + (i % 2 ? error : -error);
    path.push_back({static_cast<double>(i) / 30.0,
                    Se3(Eigen::Quaterniond::Identity(),
                        Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), 1.2))});
  }
  return path;
}

ScoredPath scored(const std::string& name, Colour colour, const Trajectory& estimate) {
  return {name, colour, estimate, absolute_error(circle(0.0), estimate)};
}

/// Points of the lines of one colour in an SVG.
std::size_t points_of(const std::string& svg, const std::string& colour) {
  const std::regex path("<path d=\"([^\"]*)\" fill=\"none\" stroke=\"" + colour + "\"");
  std::size_t points = 0;
  for (std::sregex_iterator it(svg.begin(), svg.end(), path), end; it != end; ++it) {
    const std::string line = (*it)[1];
    points += static_cast<std::size_t>(
        std::count_if(line.begin(), line.end(), [](char c) { return c == 'M' || c == 'L'; }));
  }
  return points;
}

template <class Draw>
std::string drawn(Draw draw) {
  const auto canvas = svg_canvas(540, 430);
  draw(*canvas);
  const std::string svg = canvas->encode();
  EXPECT_EQ(MarkupCheck(svg).problem(), "");
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  return svg;
}

constexpr std::size_t legend_points = 2;  // a short line in the legend

TEST(Charts, PathsHaveAPointForEveryPose) {
  const std::vector<ScoredPath> paths{scored("first", red, circle(0.01)),
                                      scored("second", blue, circle(0.02, 60))};
  const std::string svg =
      drawn([&](Canvas& canvas) { draw_paths_from_above(canvas, box, circle(0.0), paths); });
  EXPECT_EQ(points_of(svg, "#fa0102"), 100 + legend_points);
  EXPECT_EQ(points_of(svg, "#0304fa"), 60 + legend_points);
  EXPECT_EQ(points_of(svg, "#282828"), 100 + legend_points);
  for (const char* text : {">first<", ">second<", ">true path<", ">x [m]<", ">y [m]<"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST(Charts, APathThatRunsAwayIsCutAndLeavesTheTruthReadable) {
  Trajectory away = circle(0.001);
  for (std::size_t i = 50; i < away.size(); ++i) {
    away[i].world_from_camera.translation.x() += 400.0;
  }
  const std::vector<ScoredPath> paths{scored("away", red, away)};
  const std::string svg =
      drawn([&](Canvas& canvas) { draw_paths_from_above(canvas, box, circle(0.0), paths); });
  EXPECT_LT(points_of(svg, "#fa0102"), 100U);
  EXPECT_THAT(svg, Not(HasSubstr(">100<")));  // no tick at 100 m
}

TEST(Charts, ErrorsAreLogarithmicWhereTheyDifferMuch) {
  const std::vector<ScoredPath> alike{scored("a", red, circle(0.01)),
                                      scored("b", blue, circle(0.02))};
  const std::vector<ScoredPath> apart{scored("a", red, circle(0.002)),
                                      scored("b", blue, circle(0.2))};
  const auto svg_of = [](const std::vector<ScoredPath>& paths) {
    return drawn([&](Canvas& canvas) { draw_errors_over_time(canvas, box, paths); });
  };
  EXPECT_THAT(svg_of(alike), HasSubstr(">error [m]<"));
  const std::string svg = svg_of(apart);
  EXPECT_THAT(svg, HasSubstr(">error [m], logarithmic<"));
  EXPECT_THAT(svg, HasSubstr(">0.01<"));
  EXPECT_EQ(points_of(svg, "#fa0102"), 100 + legend_points);
}

TEST(Charts, ACameraAtRestAndAPerfectPathStillGivePictures) {
  Trajectory still(30);
  for (std::size_t i = 0; i < still.size(); ++i) still[i].timestamp = 0.1 * static_cast<double>(i);
  const std::vector<ScoredPath> paths{{"still", red, still, absolute_error(still, still)}};
  drawn([&](Canvas& canvas) { draw_paths_from_above(canvas, box, still, paths); });
  drawn([&](Canvas& canvas) { draw_errors_over_time(canvas, box, paths); });
}

}  // namespace
}  // namespace dkp_slam
