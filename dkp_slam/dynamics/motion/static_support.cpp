#include "dkp_slam/dynamics/motion/static_support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "dkp_slam/geometry/depth_at.h"

namespace dkp_slam {

std::vector<std::uint8_t> outside_boxes(const std::vector<cv::Point2f>& points,
                                        const std::vector<cv::Rect2f>& boxes) {
  std::vector<std::uint8_t> outside(points.size(), 1);
  for (const cv::Rect2f& box : boxes) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (box.contains(points[i])) outside[i] = 0;
    }
  }
  return outside;
}

std::vector<std::uint8_t> thinned_outside(const std::vector<cv::Point2f>& points,
                                          const std::vector<cv::Rect2f>& boxes, float margin,
                                          const cv::Mat& depth, int most) {
  std::vector<cv::Rect2f> grown;
  for (const cv::Rect2f& b : boxes) {
    grown.emplace_back(b.x - margin, b.y - margin, b.width + 2 * margin, b.height + 2 * margin);
  }
  std::vector<std::uint8_t> taken = outside_boxes(points, grown);
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool outside = taken[i] != 0;
    taken[i] = outside ? 0 : 1;
    if (!outside) continue;
    if (depth_at(depth, points[i]) > 0.0F) others.push_back(i);
  }
  const std::size_t count = std::min(others.size(), static_cast<std::size_t>(most));
  for (std::size_t k = 0; k < count; ++k) taken[others[k * others.size() / count]] = 1;
  return taken;
}

std::vector<std::uint8_t> near_moving(const std::vector<cv::Point2f>& points,
                                      const std::vector<float>& residual, float moving,
                                      const cv::Size& size) {
  // Eight by eight parts: one is as wide as a person three metres away. Each is judged with its
  // neighbours to the right and below, and all four are flagged.
  constexpr int parts = 8;
  struct Count {
    int measured = 0, moving = 0;
  };
  std::array<std::array<Count, parts>, parts> counts{};
  std::array<std::array<bool, parts>, parts> open{};
  const auto part_of = [&](const cv::Point2f& p) {
    const auto of = [](float at, int side) {
      return static_cast<std::size_t>(
          std::clamp(static_cast<int>(at) * parts / std::max(side, 1), 0, parts - 1));
    };
    return std::pair(of(p.y, size.height), of(p.x, size.width));
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isnan(residual[i])) continue;
    const auto [row, column] = part_of(points[i]);
    ++counts[row][column].measured;
    if (residual[i] > moving) ++counts[row][column].moving;
  }
  for (std::size_t r = 0; r + 1 < parts; ++r) {
    for (std::size_t c = 0; c + 1 < parts; ++c) {
      Count sum;
      for (const Count& part :
           {counts[r][c], counts[r][c + 1], counts[r + 1][c], counts[r + 1][c + 1]}) {
        sum.measured += part.measured;
        sum.moving += part.moving;
      }
      if (sum.moving < 2 || 3 * sum.moving < sum.measured) continue;
      open[r][c] = open[r][c + 1] = open[r + 1][c] = open[r + 1][c + 1] = true;
    }
  }
  std::vector<std::uint8_t> flags(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [row, column] = part_of(points[i]);
    flags[i] = open[row][column] ? 1 : 0;
  }
  return flags;
}

void add_points_on_planes(const DepthView& view, const std::vector<cv::Point2f>& points,
                          const std::vector<Plane>& planes, const PlaneOptions& options,
                          std::vector<std::uint8_t>& flags) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point pixel(cvRound(points[i].x), cvRound(points[i].y));
    if (flags[i] == 0 && runs_along_any(view, planes, pixel, options)) flags[i] = 1;
  }
}

std::vector<std::uint8_t> planes_left_behind(const DepthView& view,
                                             const std::vector<cv::Point2f>& points,
                                             const std::vector<std::uint8_t>& support,
                                             const FeatureMotion& motion, float moving,
                                             const PlaneOptions& planes, std::uint64_t seed) {
  constexpr double many = 0.25, half = 0.5;  // shares of the points that do not agree
  constexpr int few = 20, least_on_planes = 30;
  const auto left_behind = [&](const std::vector<std::uint8_t>& flags) {
    int measured = 0, behind = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (flags[i] == 0 || motion.tracks.tracked[i] == 0) continue;
      ++measured;
      behind += motion.residual[i] < moving ? 0 : 1;  // all where no motion was told
    }
    return std::pair(measured, behind);
  };
  const auto [measured, behind] = left_behind(support);
  if (measured <= few || behind <= many * measured) return {};
  const PlaneOptions large = larger_than_people(planes);
  std::vector<std::uint8_t> on(points.size(), 0);
  add_points_on_planes(view, points, fit_planes(view, {}, large, seed), large, on);
  for (std::size_t i = 0; i < on.size(); ++i) {
    if (support[i] == 0) on[i] = 0;
  }
  const auto [on_planes, planes_behind] = left_behind(on);
  if (on_planes < least_on_planes || planes_behind <= half * on_planes) return {};
  return on;
}

}  // namespace dkp_slam
