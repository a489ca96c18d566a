#include "dkp_slam/detection/motion/motion_regions.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

void drop_small(cv::Mat& mask, double min_area) {
  cv::Mat labels, stats, centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, 8);
  std::vector<uchar> keep(static_cast<std::size_t>(count), 0);
  for (int i = 1; i < count; ++i)
    keep[i] = stats.at<int>(i, cv::CC_STAT_AREA) >= min_area ? 255 : 0;
  mask.forEach<uchar>(
      [&](uchar& cell, const int* at) { cell = keep[labels.at<int>(at[0], at[1])]; });
}

}  // namespace

cv::Mat grow_motion(const cv::Mat& log_odds, const cv::Mat& depth, const CoarseGrid& grid,
                    const MotionRegionOptions& options) {
  const cv::Size size = log_odds.size();
  const double min_area = options.min_share * size.area();
  cv::Mat seeds = log_odds >= options.seed;
  // Seeds one cell wide are the rims of objects that the camera's motion or the lens shifted.
  cv::morphologyEx(seeds, seeds, cv::MORPH_OPEN, cv::Mat());
  drop_small(seeds, 0.5 * min_area);

  // Dijkstra over the surface: distance in metres from the nearest seed.
  using Entry = std::pair<float, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  std::vector<float> distance(static_cast<std::size_t>(size.area()), options.reach);
  cv::Mat mask = seeds.clone();
  for (int i = 0; i < size.area(); ++i) {
    if (!seeds.at<uchar>(i / size.width, i % size.width)) continue;
    distance[static_cast<std::size_t>(i)] = 0.0F;
    open.emplace(0.0F, i);
  }
  const auto point = [&](int index, float z) -> Eigen::Vector3f { return z * grid.ray(index); };
  while (!open.empty()) {
    const auto [reached, index] = open.top();
    open.pop();
    if (reached > distance[static_cast<std::size_t>(index)]) continue;
    const int u = index % size.width, v = index / size.width;
    const float z = depth.at<float>(v, u);
    if (z <= 0.0F) continue;
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const int x = u + dx, y = v + dy;
      if (x < 0 || y < 0 || x >= size.width || y >= size.height) continue;
      const float other = depth.at<float>(y, x);
      if (other <= 0.0F || log_odds.at<float>(y, x) < options.grow ||
          std::abs(other - z) > options.step + options.step_share * z) {
        continue;
      }
      const int neighbour = y * size.width + x;
      const float length = reached + (point(index, z) - point(neighbour, other)).norm() +
                           options.depth_cost * std::abs(z - other);
      if (length >= distance[static_cast<std::size_t>(neighbour)]) continue;
      distance[static_cast<std::size_t>(neighbour)] = length;
      mask.at<uchar>(y, x) = 255;
      open.emplace(length, neighbour);
    }
  }
  // Cells without depth inside an object (hair, dark cloth) belong to it.
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::Mat(), {-1, -1}, 2);
  drop_small(mask, min_area);
  return mask;
}

std::vector<Detection> motion_detections(const cv::Mat& mask, const cv::Mat& log_odds,
                                         const CoarseGrid& grid, const cv::Size& image_size,
                                         const MotionRegionOptions& options) {
  cv::Mat labels, stats, centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, 8);
  std::vector<Detection> found;
  const int step = grid.step();
  for (int i = 1; i < count; ++i) {
    const cv::Rect cells(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                         stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
    const cv::Mat region = labels(cells) == i;
    const cv::Mat seeds = region & (log_odds(cells) >= options.seed);
    Detection detection;
    const double mean = cv::mean(log_odds(cells), seeds)[0];
    detection.score = static_cast<float>(1.0 / (1.0 + std::exp(-mean)));
    detection.class_id = Detection::motion_class;
    const cv::Rect box =
        cv::Rect(cells.x * step, cells.y * step, cells.width * step, cells.height * step) &
        cv::Rect({}, image_size);
    detection.box = cv::Rect2f(box);
    // Linear interpolation rounds the corners of the cells.
    cv::resize(region, detection.mask, box.size(), 0, 0, cv::INTER_LINEAR);
    detection.mask = detection.mask >= 128;
    found.push_back(std::move(detection));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  return found;
}

}  // namespace dkp_slam
