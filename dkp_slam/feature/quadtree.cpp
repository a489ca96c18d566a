#include <algorithm>
#include <queue>

#include "dkp_slam/feature/orb_extractor.h"

namespace dkp_slam {
namespace {

struct Node {
  cv::Rect2f area;
  std::vector<int> members;  // indices of keypoints
};

/// The node's non-empty quarters.
std::vector<Node> split(const Node& node, const std::vector<cv::KeyPoint>& keypoints) {
  const float half_width = 0.5F * node.area.width, half_height = 0.5F * node.area.height;
  const float middle_x = node.area.x + half_width, middle_y = node.area.y + half_height;
  std::vector<Node> quarters(4);
  for (int q = 0; q < 4; ++q) {
    quarters[static_cast<std::size_t>(q)].area = cv::Rect2f(
        q % 2 ? middle_x : node.area.x, q / 2 ? middle_y : node.area.y, half_width, half_height);
  }
  for (const int i : node.members) {
    const cv::Point2f& p = keypoints[static_cast<std::size_t>(i)].pt;
    quarters[static_cast<std::size_t>((p.x >= middle_x) + 2 * (p.y >= middle_y))].members.push_back(
        i);
  }
  std::erase_if(quarters, [](const Node& n) { return n.members.empty(); });
  return quarters;
}

}  // namespace

std::vector<cv::KeyPoint> spread_by_quadtree(const std::vector<cv::KeyPoint>& keypoints,
                                             const cv::Rect2f& area, int wanted) {
  if (static_cast<int>(keypoints.size()) <= wanted) return keypoints;
  std::vector<Node> nodes;
  // Roughly square roots, so that leaves are square too.
  const int roots = std::max(1, cvRound(area.width / area.height));
  nodes.resize(static_cast<std::size_t>(roots));
  const float root_width = area.width / static_cast<float>(roots);
  for (int r = 0; r < roots; ++r) {
    nodes[static_cast<std::size_t>(r)].area =
        cv::Rect2f(area.x + static_cast<float>(r) * root_width, area.y, root_width, area.height);
  }
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const int r =
        std::clamp(static_cast<int>((keypoints[i].pt.x - area.x) / root_width), 0, roots - 1);
    nodes[static_cast<std::size_t>(r)].members.push_back(static_cast<int>(i));
  }

  // The largest node is split first, which spreads the leaves evenly over the area rather than over
  // the corners; then the fullest, then the oldest, so that the result never varies.
  const auto later = [&](int a, int b) {
    const float area_a = nodes[static_cast<std::size_t>(a)].area.area();
    const float area_b = nodes[static_cast<std::size_t>(b)].area.area();
    if (area_a != area_b) return area_a < area_b;
    const std::size_t na = nodes[static_cast<std::size_t>(a)].members.size();
    const std::size_t nb = nodes[static_cast<std::size_t>(b)].members.size();
    return na != nb ? na < nb : a > b;
  };
  std::priority_queue<int, std::vector<int>, decltype(later)> queue(later);
  int leaves = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].members.empty()) continue;
    queue.push(static_cast<int>(i));
    ++leaves;
  }
  while (leaves < wanted && !queue.empty()) {
    const auto next = static_cast<std::size_t>(queue.top());
    queue.pop();
    if (nodes[next].members.size() < 2 || nodes[next].area.width < 1.0F) continue;
    const Node node = std::move(nodes[next]);
    nodes[next].members.clear();
    --leaves;
    for (Node& quarter : split(node, keypoints)) {
      nodes.push_back(std::move(quarter));
      queue.push(static_cast<int>(nodes.size()) - 1);
      ++leaves;
    }
  }

  std::vector<cv::KeyPoint> kept;
  kept.reserve(static_cast<std::size_t>(leaves));
  for (const Node& node : nodes) {
    if (node.members.empty()) continue;
    const int best = *std::max_element(node.members.begin(), node.members.end(), [&](int a, int b) {
      const float ra = keypoints[static_cast<std::size_t>(a)].response;
      const float rb = keypoints[static_cast<std::size_t>(b)].response;
      return ra != rb ? ra < rb : a > b;
    });
    kept.push_back(keypoints[static_cast<std::size_t>(best)]);
  }
  return kept;
}

}  // namespace dkp_slam
