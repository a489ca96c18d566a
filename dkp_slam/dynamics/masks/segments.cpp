#include "dkp_slam/dynamics/masks/segments.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace dkp_slam {
namespace {

/// Union-find over provisional labels, roots are the smallest of their set.
class LabelSets {
 public:
  int add() {
    parent_.push_back(static_cast<int>(parent_.size()));
    return parent_.back();
  }
  int root(int label) {
    while (parent_[static_cast<std::size_t>(label)] != label) {
      auto& p = parent_[static_cast<std::size_t>(label)];
      p = parent_[static_cast<std::size_t>(p)];
      label = p;
    }
    return label;
  }
  int join(int a, int b) {
    a = root(a);
    b = root(b);
    if (a > b) std::swap(a, b);
    parent_[static_cast<std::size_t>(b)] = a;
    return a;
  }
  /// The root of every label.
  std::vector<int> roots() const {
    std::vector<int> all = parent_;
    for (int& p : all) p = all[static_cast<std::size_t>(p)];  // parents come before their children
    return all;
  }

 private:
  std::vector<int> parent_{0};  // label 0 is "none"
};

/// Sums of a surface's points for its plane.
struct Moments {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  int count = 0;
  void add(const Eigen::Vector3f& p) {
    sum += p;
    squares.noalias() += p * p.transpose();
    ++count;
  }
  /// Root mean square distance from the best plane, metres.
  double thickness() const {
    const Eigen::Vector3d mean = sum.cast<double>() / count;
    const Eigen::Matrix3d spread = squares.cast<double>() / count - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
  }
};

void find_flat_segments(const DepthView& view, const SegmentOptions& options, SegmentMap& map) {
  std::vector<Moments> moments(map.segments.size());
  constexpr int stride = 2;  // enough points for a plane, a quarter of the time
  for (int y = 0; y < map.labels.rows; y += stride) {
    const int* label = map.labels.ptr<int>(y);
    for (int x = 0; x < map.labels.cols; x += stride) {
      if (label[x] == 0) continue;
      const auto i = static_cast<std::size_t>(label[x] - 1);
      if (map.segments[i].area >= options.flat_area) moments[i].add(view.point(x, y));
    }
  }
  const cv::Vec2f seen = view.rays.at<cv::Vec2f>(view.rays.rows - 1, view.rays.cols - 1) -
                         view.rays.at<cv::Vec2f>(0, 0);
  const double pixel =  // square metres of it, a metre away
      static_cast<double>(seen[0] * seen[1]) / static_cast<double>(view.rays.total());
  for (std::size_t i = 0; i < moments.size(); ++i) {
    if (moments[i].count < 10) continue;
    Segment& s = map.segments[i];
    const double z = static_cast<double>(s.mean_depth);
    s.flat = moments[i].thickness() < options.flat_constant + options.flat_quadratic * z * z;
    s.large = s.flat && s.area * z * z * pixel > options.thing_area;
  }
}

/// Second pass: the roots of provisional labels become consecutive numbers, and segments.
void number_segments(const DepthView& view, const std::vector<int>& roots, SegmentMap& map) {
  std::vector<int> final_label(roots.size(), 0);
  std::vector<double> depth_sum;
  std::vector<cv::Point> low, high;
  for (int y = 0; y < view.depth.rows; ++y) {
    const float* depth = view.depth.ptr<float>(y);
    int* label = map.labels.ptr<int>(y);
    for (int x = 0; x < view.depth.cols;) {
      const int provisional = label[x];
      if (provisional == 0) {
        ++x;
        continue;
      }
      const int root = roots[static_cast<std::size_t>(provisional)];
      int& number = final_label[static_cast<std::size_t>(root)];
      if (number == 0) {
        map.segments.emplace_back();
        depth_sum.push_back(0.0);
        low.emplace_back(x, y);
        high.emplace_back(x, y);
        number = static_cast<int>(map.segments.size());
      }
      const auto i = static_cast<std::size_t>(number - 1);
      const int first = x;
      double sum = depth_sum[i];
      for (; x < view.depth.cols && label[x] == provisional; ++x) {
        sum += static_cast<double>(depth[x]);
        label[x] = number;
      }
      depth_sum[i] = sum;
      map.segments[i].area += x - first;
      low[i].x = std::min(low[i].x, first);
      high[i] = {std::max(high[i].x, x - 1), y};
    }
  }
  for (std::size_t i = 0; i < map.segments.size(); ++i) {
    map.segments[i].mean_depth = static_cast<float>(depth_sum[i] / map.segments[i].area);
    map.segments[i].box = cv::Rect(low[i], high[i] + cv::Point(1, 1));
  }
}

}  // namespace

SegmentMap segment_surfaces(const DepthView& view, const cv::Mat& excluded,
                            const SegmentOptions& options) {
  SegmentMap map;
  map.labels = cv::Mat::zeros(view.depth.size(), CV_32SC1);
  LabelSets sets;
  const auto constant = static_cast<float>(options.step_constant);
  const auto quadratic = static_cast<float>(options.step_quadratic);
  for (int y = 0; y < view.depth.rows; ++y) {
    const float* depth = view.depth.ptr<float>(y);
    const float* depth_above = y > 0 ? view.depth.ptr<float>(y - 1) : nullptr;
    const std::uint8_t* skip = excluded.empty() ? nullptr : excluded.ptr<std::uint8_t>(y);
    int* label = map.labels.ptr<int>(y);
    const int* label_above = y > 0 ? map.labels.ptr<int>(y - 1) : nullptr;
    for (int x = 0; x < view.depth.cols; ++x) {
      const float z = depth[x];
      if (z <= 0.0F || (skip != nullptr && skip[x] != 0)) continue;
      const float step = constant + quadratic * z * z;
      const int left = x > 0 && std::abs(depth[x - 1] - z) < step ? label[x - 1] : 0;
      const int above =
          depth_above != nullptr && std::abs(depth_above[x] - z) < step ? label_above[x] : 0;
      if (left != 0 && above != 0) {
        label[x] = left == above ? left : sets.join(left, above);
      } else if (left != 0 || above != 0) {
        label[x] = std::max(left, above);
      } else {
        label[x] = sets.add();
      }
    }
  }
  number_segments(view, sets.roots(), map);
  find_flat_segments(view, options, map);
  return map;
}

int segment_near(const SegmentMap& map, int x, int y) {
  int best = -1;
  constexpr int reach = 2;
  for (const int r : {0, reach}) {
    for (int dy = -r; dy <= r; dy += reach) {
      for (int dx = -r; dx <= r; dx += reach) {
        const int px = x + dx, py = y + dy;
        if (px < 0 || py < 0 || px >= map.labels.cols || py >= map.labels.rows) continue;
        const int label = map.labels.at<int>(py, px);
        if (label == 0) continue;
        const float depth = map.segments[static_cast<std::size_t>(label - 1)].mean_depth;
        if (best < 0 || depth < map.segments[static_cast<std::size_t>(best)].mean_depth) {
          best = label - 1;
        }
      }
    }
    if (best >= 0) break;
  }
  return best;
}

}  // namespace dkp_slam
