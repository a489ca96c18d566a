#include <algorithm>
#include <numeric>
#include <queue>
#include <vector>

#include "dkp_slam/feature/orb_extractor.h"

namespace dkp_slam {
namespace {

struct Node {
  cv::Rect2f area;
  int first = 0, count = 0;  // its keypoints: this stretch of the tree's order
};

/// Splits an area again and again; holds its leaves, and nodes without keypoints where leaves were
/// split.
class Quadtree {
 public:
  Quadtree(const std::vector<cv::KeyPoint>& keypoints, const cv::Rect2f& area)
      : keypoints_(keypoints), order_(keypoints.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    // Roughly square roots, so that leaves are square too.
    const int roots = std::max(1, cvRound(area.width / area.height));
    const float width = area.width / static_cast<float>(roots);
    const auto root_of = [&](int k) {
      return std::clamp(static_cast<int>((point(k).x - area.x) / width), 0, roots - 1);
    };
    int first = 0;
    for (int r = 0; r < roots; ++r) {
      const int end = part(first, size(), [&](int k) { return root_of(k) == r; });
      add({{area.x + static_cast<float>(r) * width, area.y, width, area.height},
           first,
           end - first});
      first = end;
    }
  }

  void split_until(int wanted) {
    while (leaves_ < wanted && !queue_.empty()) {
      const auto next = static_cast<std::size_t>(queue_.top().node);
      queue_.pop();
      if (nodes_[next].count < 2 || nodes_[next].area.width < 1.0F) continue;
      const Node node = nodes_[next];
      nodes_[next].count = 0;
      --leaves_;
      split(node);
    }
  }

  /// The strongest keypoint of every leaf.
  std::vector<cv::KeyPoint> strongest() const {
    std::vector<cv::KeyPoint> kept;
    kept.reserve(static_cast<std::size_t>(leaves_));
    for (const Node& node : nodes_) {
      if (node.count == 0) continue;
      const auto first = order_.begin() + node.first;
      const int best = *std::max_element(first, first + node.count, [&](int a, int b) {
        const float ra = keypoints_[static_cast<std::size_t>(a)].response;
        const float rb = keypoints_[static_cast<std::size_t>(b)].response;
        return ra != rb ? ra < rb : a > b;
      });
      kept.push_back(keypoints_[static_cast<std::size_t>(best)]);
    }
    return kept;
  }

 private:
  /// The largest node is split first, which spreads the leaves evenly over the area rather than
  /// over the corners; then the fullest, then the oldest, so that the result never varies.
  struct Waiting {
    float area;
    int count, node;
    bool operator<(const Waiting& other) const {
      if (area != other.area) return area < other.area;
      return count != other.count ? count < other.count : node > other.node;
    }
  };

  int size() const { return static_cast<int>(order_.size()); }
  const cv::Point2f& point(int k) const { return keypoints_[static_cast<std::size_t>(k)].pt; }

  /// Brings keypoints of the stretch for which `first_part` holds to its front; where they end.
  template <typename Predicate>
  int part(int first, int end, const Predicate& first_part) {
    const auto begin = order_.begin();
    return static_cast<int>(std::partition(begin + first, begin + end, first_part) - begin);
  }

  void add(const Node& node) {
    if (node.count > 0) {
      queue_.push({node.area.area(), node.count, static_cast<int>(nodes_.size())});
      nodes_.push_back(node);
      ++leaves_;
    }
  }

  void split(const Node& node) {
    const float width = 0.5F * node.area.width, height = 0.5F * node.area.height;
    const float middle_x = node.area.x + width, middle_y = node.area.y + height;
    const auto left = [&](int k) { return point(k).x < middle_x; };
    const int end = node.first + node.count;
    const int bottom = part(node.first, end, [&](int k) { return point(k).y < middle_y; });
    const int top_right = part(node.first, bottom, left);
    const int bottom_right = part(bottom, end, left);
    add({{node.area.x, node.area.y, width, height}, node.first, top_right - node.first});
    add({{middle_x, node.area.y, width, height}, top_right, bottom - top_right});
    add({{node.area.x, middle_y, width, height}, bottom, bottom_right - bottom});
    add({{middle_x, middle_y, width, height}, bottom_right, end - bottom_right});
  }

  const std::vector<cv::KeyPoint>& keypoints_;
  std::vector<int> order_;  // indices of keypoints
  std::vector<Node> nodes_;
  std::priority_queue<Waiting> queue_;
  int leaves_ = 0;
};

}  // namespace

std::vector<cv::KeyPoint> spread_by_quadtree(const std::vector<cv::KeyPoint>& keypoints,
                                             const cv::Rect2f& area, int wanted) {
  if (static_cast<int>(keypoints.size()) <= wanted) return keypoints;
  Quadtree tree(keypoints, area);
  tree.split_until(wanted);
  return tree.strongest();
}

}  // namespace dkp_slam
