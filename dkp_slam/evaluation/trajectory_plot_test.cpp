#include "dkp_slam/evaluation/trajectory_plot.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/image_files.h"

namespace dkp_slam {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

Trajectory circle_in_yz(double noise) {
  Trajectory poses;
  for (int i = 0; i < 100; ++i) {
    const double angle = 0.06 * i;
    poses.push_back({i / 30.0, Se3(Eigen::Quaterniond::Identity(),
                                   Eigen::Vector3d(noise * std::sin(7.0 * angle), std::cos(angle),
                                                   std::sin(angle)))});
  }
  return poses;
}

std::string drawn(Canvas& canvas, const Trajectory& truth, const Trajectory& estimate) {
  draw_trajectories(canvas, truth, estimate, absolute_error(truth, estimate), {}, "<title> & more");
  return canvas.encode();
}

/// How many times `part` stands in `text`.
std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Ticks, AreRoundNumbersWithinTheRange) {
  EXPECT_THAT(ticks(0.0, 1.0, 5),
              ElementsAre(0.0, DoubleNear(0.2, 1e-12), DoubleNear(0.4, 1e-12),
                          DoubleNear(0.6, 1e-12), DoubleNear(0.8, 1e-12), DoubleNear(1.0, 1e-12)));
  EXPECT_THAT(ticks(-7.0, 12.0, 4), ElementsAre(-5.0, 0.0, 5.0, 10.0));
  EXPECT_THAT(ticks(0.0, 0.0031, 3), ElementsAre(0.0, DoubleNear(0.002, 1e-12)));
}

TEST(TrajectoryPlot, SvgShowsTheWidestPlaneTheLegendAndEscapedText) {
  auto canvas = svg_canvas(plot_width, plot_height);
  const std::string svg = drawn(*canvas, circle_in_yz(0.0), circle_in_yz(0.05));
  EXPECT_THAT(svg, HasSubstr("<svg xmlns="));
  EXPECT_THAT(svg, HasSubstr(">y [m]</text>"));
  EXPECT_THAT(svg, HasSubstr(">z [m]</text>"));
  EXPECT_THAT(svg, Not(HasSubstr(">x [m]</text>")));
  EXPECT_THAT(svg, HasSubstr("&lt;title&gt; &amp; more"));
  for (const char* name : {"ground truth", "estimate", "difference", "RMSE", "time [s]"}) {
    EXPECT_THAT(svg, HasSubstr(name));
  }
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(TrajectoryPlot, ThePathIsBrokenWhereFramesAreLost) {
  const Trajectory truth = circle_in_yz(0.0);
  Trajectory estimate = truth;
  const auto strokes = [&] {
    auto canvas = svg_canvas(plot_width, plot_height);
    return occurrences(drawn(*canvas, truth, estimate), "M");
  };
  const std::size_t whole = strokes();
  estimate.erase(estimate.begin() + 40, estimate.begin() + 50);
  // Ten differences fewer; one stroke more in the path and one more in the error over time.
  EXPECT_EQ(strokes(), whole - 10 + 2);
}

TEST(TrajectoryPlot, PngHasTwoPixelsAPointAndTheColoursOfThePaths) {
  auto canvas = png_canvas(plot_width, plot_height);
  const std::string png = drawn(*canvas, circle_in_yz(0.0), circle_in_yz(0.3));
  const cv::Mat image = testing::image_of(std::vector<uchar>(png.begin(), png.end()));
  ASSERT_EQ(image.size(), cv::Size(2 * plot_width, 2 * plot_height));
  cv::Mat blue;
  cv::inRange(image, cv::Scalar(180, 100, 20), cv::Scalar(200, 120, 45), blue);
  EXPECT_GT(cv::countNonZero(blue), 1000);
}

TEST(TrajectoryPlot, ACameraAtRestStillGivesAPicture) {
  Trajectory still(50);
  for (std::size_t i = 0; i < still.size(); ++i) still[i].timestamp = 0.1 * static_cast<double>(i);
  auto canvas = svg_canvas(plot_width, plot_height);
  const std::string svg = drawn(*canvas, still, still);
  EXPECT_THAT(svg, HasSubstr(">x [m]</text>"));
  EXPECT_THAT(svg, HasSubstr(">y [m]</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

}  // namespace
}  // namespace dkp_slam
