#include "dkp_slam/optimization/pose_graph.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

double distance(const Se3& a, const Se3& b) { return (a * b.inverse()).log().norm(); }

/// A camera that looks outward from a circle of 2 m, once around.
std::vector<Se3> circle(int count) {
  std::vector<Se3> poses;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * M_PI * i / count;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
    poses.push_back(
        Se3(turn, {2.0 * std::sin(angle), 0.1 * std::sin(3.0 * angle), 2.0 * std::cos(angle)})
            .inverse());
  }
  return poses;
}

/// The circle as a camera would think it was that sinks and turns a little too far at each step,
/// with an edge per step as it was measured; and one true edge that closes it.
PoseGraph drifted(const std::vector<Se3>& truth) {
  Vector6d error;
  error << 0.0, 0.01, 0.0, 0.0, 0.006, 0.0;
  PoseGraph graph;
  graph.nodes.push_back({truth[0], true});
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Se3 step = Se3::exp(error) * truth[i] * truth[i - 1].inverse();
    graph.nodes.push_back({step * graph.nodes.back().camera_from_world, false});
    graph.edges.push_back({static_cast<int>(i) - 1, static_cast<int>(i), step});
  }
  graph.edges.push_back({static_cast<int>(truth.size()) - 1, 0, truth[0] * truth.back().inverse()});
  return graph;
}

double rmse(const std::vector<Se3>& poses, const std::vector<Se3>& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    sum += (poses[i].inverse().translation - truth[i].inverse().translation).squaredNorm();
  }
  return std::sqrt(sum / double(poses.size()));
}

TEST(PoseGraphTest, ExactEdgesGiveTheExactPoses) {
  const std::vector<Se3> truth = circle(40);
  PoseGraph graph = drifted(truth);
  for (PoseGraph::Edge& e : graph.edges) {
    e.to_from_from = truth[std::size_t(e.to)] * truth[std::size_t(e.from)].inverse();
  }
  const std::vector<Se3> poses = optimize_pose_graph(graph);
  ASSERT_EQ(poses.size(), truth.size());
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_LT(distance(poses[i], truth[i]), 1e-5);
}

TEST(PoseGraphTest, OneClosedLoopTakesDriftAway) {
  const std::vector<Se3> truth = circle(60);
  const PoseGraph graph = drifted(truth);
  std::vector<Se3> before;
  for (const PoseGraph::Node& n : graph.nodes) before.push_back(n.camera_from_world);
  const std::vector<Se3> after = optimize_pose_graph(graph);
  EXPECT_GT(rmse(before, truth), 0.2);
  EXPECT_LT(rmse(after, truth), rmse(before, truth) / 5.0);
  EXPECT_LT(
      distance(after.back() * after.front().inverse(), truth.back() * truth.front().inverse()),
      0.02);
  EXPECT_EQ(distance(after.front(), truth.front()), 0.0);
}

TEST(PoseGraphTest, RepeatsExactly) {
  const PoseGraph graph = drifted(circle(30));
  const std::vector<Se3> first = optimize_pose_graph(graph), second = optimize_pose_graph(graph);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].translation, second[i].translation);
    EXPECT_EQ(first[i].rotation.coeffs(), second[i].rotation.coeffs());
  }
}

TEST(PoseGraphTest, StaysWithoutEdgesOrWhenStopped) {
  PoseGraph graph = drifted(circle(10));
  const std::atomic<bool> stop = true;
  const Se3 last = graph.nodes.back().camera_from_world;
  EXPECT_EQ(optimize_pose_graph(graph, {}, &stop).back().translation, last.translation);
  graph.edges.clear();
  EXPECT_EQ(optimize_pose_graph(graph).back().translation, last.translation);
  EXPECT_TRUE(optimize_pose_graph({}).empty());
}

}  // namespace
}  // namespace dkp_slam
