#include "dkp_slam/dynamics/compensation/object_flow.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

/// Features in rows of ten, 10 px apart from (10, 10) on, that moved by `flow`.
FlowResult moved(const std::vector<cv::Point2f>& points, const cv::Point2f& flow) {
  FlowResult tracks;
  for (const cv::Point2f& p : points) tracks.previous.push_back(p - flow);
  tracks.tracked.assign(points.size(), 1);
  return tracks;
}

std::vector<cv::Point2f> row(int count) {
  std::vector<cv::Point2f> points;
  for (int i = 0; i < count; ++i) points.emplace_back(10.0F + 10.0F * float(i), 10.0F);
  return points;
}

TEST(ObjectFlow, IsTheMedianOfThePointsInTheMask) {
  const auto points = row(10);
  FlowResult tracks = moved(points, {4.0F, -2.0F});
  tracks.previous[3] = points[3] - cv::Point2f(50.0F, 0.0F);  // a wrong match, still in the mask
  cv::Mat labels(40, 200, CV_8UC1, cv::Scalar(0));
  labels.colRange(0, 70) = 1;
  const auto flow = object_flow(points, tracks, labels, 2);
  ASSERT_EQ(flow.size(), 2U);
  ASSERT_TRUE(flow[0].has_value());
  EXPECT_FLOAT_EQ(flow[0]->x, 4.0F);
  EXPECT_FLOAT_EQ(flow[0]->y, -2.0F);
  EXPECT_FALSE(flow[1].has_value());  // nothing bears its label
}

TEST(ObjectFlow, SaysNothingFromFourPointsOrFromLostOnes) {
  cv::Mat labels(40, 200, CV_8UC1, cv::Scalar(1));
  EXPECT_FALSE(object_flow(row(4), moved(row(4), {1, 0}), labels, 1)[0].has_value());
  EXPECT_TRUE(object_flow(row(5), moved(row(5), {1, 0}), labels, 1)[0].has_value());
  FlowResult lost = moved(row(5), {1, 0});
  lost.tracked[2] = 0;
  EXPECT_FALSE(object_flow(row(5), lost, labels, 1)[0].has_value());
  EXPECT_FALSE(object_flow(row(5), moved(row(5), {1, 0}), {}, 1)[0].has_value());
}

}  // namespace
}  // namespace dkp_slam
