#include "dkp_slam/dynamics/compensation/object_flow.h"

#include <algorithm>

#include "dkp_slam/geometry/nearest_pixel.h"

namespace dkp_slam {
namespace {

std::uint8_t label_of(const cv::Mat& labels, const cv::Point2f& p) {
  return labels.at<std::uint8_t>(nearest_pixel(labels.size(), p));
}

}  // namespace

cv::Point2f median_flow(std::vector<cv::Point2f> vectors) {
  const auto middle = vectors.begin() + static_cast<std::ptrdiff_t>(vectors.size() / 2);
  std::nth_element(vectors.begin(), middle, vectors.end(),
                   [](const cv::Point2f& a, const cv::Point2f& b) { return a.x < b.x; });
  const float x = middle->x;
  std::nth_element(vectors.begin(), middle, vectors.end(),
                   [](const cv::Point2f& a, const cv::Point2f& b) { return a.y < b.y; });
  return {x, middle->y};
}

std::vector<std::optional<cv::Point2f>> object_flow(const std::vector<cv::Point2f>& points,
                                                    const FlowResult& tracks, const cv::Mat& labels,
                                                    std::size_t count) {
  std::vector<std::vector<cv::Point2f>> vectors(count);
  for (std::size_t i = 0; i < points.size() && !labels.empty(); ++i) {
    if (tracks.tracked[i] == 0) continue;
    const std::size_t label = label_of(labels, tracks.previous[i]);
    if (label == 0 || label > count) continue;
    vectors[label - 1].push_back(points[i] - tracks.previous[i]);
  }
  std::vector<std::optional<cv::Point2f>> result(count);
  constexpr std::size_t min_points = 5;  // a median of fewer follows a single wrong match
  for (std::size_t o = 0; o < count; ++o) {
    if (vectors[o].size() >= min_points) result[o] = median_flow(std::move(vectors[o]));
  }
  return result;
}

}  // namespace dkp_slam
