#include "dkp_slam/dynamics/clustering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/dynamics/kmeans.h"

namespace dkp_slam {
namespace {

struct DepthInterval {
  float low = 0.0F;
  float high = 0.0F;
  bool holds(float z) const { return z > 0.0F && z >= low && z < high; }
};

bool flagged(const cv::Mat& mask, int x, int y) {
  return !mask.empty() && mask.at<std::uint8_t>(y, x) != 0;
}

/// Depths of the box's pixels that do not lie on a plane.
DepthHistogram histogram_of(const DepthView& view, const cv::Mat& planes, const cv::Rect& box) {
  DepthHistogram histogram;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      const float z = view.depth.at<float>(y, x);
      if (z > 0.0F && !flagged(planes, x, y)) histogram.add(z);
    }
  }
  return histogram;
}

cv::Rect central_half(const cv::Rect& box) {
  return {box.x + box.width / 4, box.y + box.height / 4, std::max(1, box.width / 2),
          std::max(1, box.height / 2)};
}

/// Nearest depth around which at least a given share of the pixels gathers; 0 when there is none.
float dominant_near_mode(const DepthHistogram& histogram, double min_share, double thickness) {
  const auto reach = static_cast<int>(0.5 * thickness / histogram.bin_width());
  const double needed = min_share * histogram.total();
  int window = 0;
  for (int b = -reach; b < histogram.bins(); ++b) {  // b is the window's centre
    if (b + reach < histogram.bins()) window += histogram.count(b + reach);
    if (b - reach - 1 >= 0) window -= histogram.count(b - reach - 1);
    if (b < 0 || window <= 0 || window < needed) continue;
    // Slide on while the window still gains: its fullest place is the mode.
    int best = b, best_count = window;
    for (int c = b + 1; c <= b + 2 * reach && c < histogram.bins(); ++c) {
      if (c + reach < histogram.bins()) window += histogram.count(c + reach);
      if (c - reach - 1 >= 0) window -= histogram.count(c - reach - 1);
      if (window > best_count) {
        best = c;
        best_count = window;
      }
    }
    return histogram.centre(best);
  }
  return 0.0F;
}

/// Algorithm 1 line 4: half width of the depth interval around T that holds a share R.
float matched_half_width(const DepthHistogram& histogram, float mean_depth, float share) {
  const double wanted = static_cast<double>(share) * histogram.total();
  float half = histogram.bin_width();
  constexpr float widest = 1.0F;
  while (half < widest &&
         histogram.count_between(mean_depth - half, mean_depth + half) < wanted) {
    half += histogram.bin_width();
  }
  return half;
}

/// Intervals of depth that belong to the object, and K.
DepthInterval object_interval(const DepthHistogram& histogram, float mean_depth, float share,
                              const ClusteringOptions& options, std::uint64_t seed, int* k_used) {
  const float half = matched_half_width(histogram, mean_depth, share);
  int k = 1;
  if (options.mode == ClusteringMode::paper) {
    const int n = std::max(1, DepthView::step * DepthView::step *
                                  histogram.count_between(mean_depth - half, mean_depth + half));
    const double raw_max = options.raw_depth_scale * static_cast<double>(histogram.max_value());
    constexpr double sane = 64.0;  // K of a mask of a few pixels would otherwise be thousands
    k = static_cast<int>(std::clamp(std::round(raw_max / n), 1.0, sane));
  } else if (options.mode == ClusteringMode::adaptive) {
    const double layers = static_cast<double>(histogram.max_value()) / (2.0 * half);
    k = static_cast<int>(std::clamp(std::round(layers), static_cast<double>(options.min_clusters),
                                    static_cast<double>(options.max_clusters)));
  } else {
    *k_used = 0;
    const auto band = static_cast<float>(options.band);
    return {mean_depth - band, mean_depth + band};
  }
  const std::vector<DepthCluster> clusters = kmeans(histogram, k, seed);
  *k_used = static_cast<int>(clusters.size());
  if (clusters.empty()) return {};
  const auto chosen = std::min_element(
      clusters.begin(), clusters.end(), [&](const DepthCluster& a, const DepthCluster& b) {
        return std::abs(a.centre - mean_depth) < std::abs(b.centre - mean_depth);
      });
  DepthInterval interval{chosen->low, chosen->high};
  if (options.mode == ClusteringMode::paper) return interval;
  for (const DepthCluster& c : clusters) {
    if (std::abs(c.centre - chosen->centre) > static_cast<float>(options.join_distance)) continue;
    interval.low = std::min(interval.low, c.low);
    interval.high = std::max(interval.high, c.high);
  }
  return interval;
}

/// Keeps the blobs of at least `min_share` of all.
void drop_small_blobs(cv::Mat& mask, double min_share) {
  cv::Mat labels, stats, centroids;
  const int n = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8, CV_16U);
  int total = 0;
  for (int i = 1; i < n; ++i) total += stats.at<int>(i, cv::CC_STAT_AREA);
  std::vector<std::uint8_t> keep(static_cast<std::size_t>(n), 0);
  for (int i = 1; i < n; ++i) {
    keep[static_cast<std::size_t>(i)] = stats.at<int>(i, cv::CC_STAT_AREA) >= min_share * total;
  }
  for (int y = 0; y < mask.rows; ++y) {
    auto* m = mask.ptr<std::uint8_t>(y);
    const auto* l = labels.ptr<std::uint16_t>(y);
    for (int x = 0; x < mask.cols; ++x) m[x] = keep[l[x]] != 0 ? 255 : 0;
  }
}

/// Floods from the mask's pixels over `candidates` without crossing a step in depth.
void grow_over_surface(const DepthView& view, const cv::Rect& area, const cv::Mat& candidates,
                       const ClusteringOptions& options, cv::Mat& mask) {
  std::vector<cv::Point> front;
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      if (mask.at<std::uint8_t>(y, x) != 0) front.emplace_back(x, y);
    }
  }
  constexpr int moves[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  while (!front.empty()) {
    const cv::Point p = front.back();
    front.pop_back();
    const float z = view.depth.at<float>(p.y + area.y, p.x + area.x);
    const auto step = static_cast<float>(options.step_constant) +
                      static_cast<float>(options.step_share) * z;
    for (const auto& move : moves) {
      const int x = p.x + move[0], y = p.y + move[1];
      if (x < 0 || y < 0 || x >= mask.cols || y >= mask.rows) continue;
      if (mask.at<std::uint8_t>(y, x) != 0 || candidates.at<std::uint8_t>(y, x) == 0) continue;
      if (std::abs(view.depth.at<float>(y + area.y, x + area.x) - z) > step) continue;
      mask.at<std::uint8_t>(y, x) = 255;
      front.emplace_back(x, y);
    }
  }
}

cv::Rect grown(const cv::Rect& box, double share, const cv::Size& size) {
  const int dx = static_cast<int>(share * box.width), dy = static_cast<int>(share * box.height);
  return cv::Rect(box.x - dx, box.y - dy, box.width + 2 * dx, box.height + 2 * dy) &
         cv::Rect(0, 0, size.width, size.height);
}

}  // namespace

cv::Rect view_rect(const cv::Rect2f& box, const cv::Size& view_size) {
  constexpr auto step = static_cast<float>(DepthView::step);
  const int x0 = static_cast<int>(std::floor(box.x / step));
  const int y0 = static_cast<int>(std::floor(box.y / step));
  const int x1 = static_cast<int>(std::ceil((box.x + box.width) / step));
  const int y1 = static_cast<int>(std::ceil((box.y + box.height) / step));
  return cv::Rect(x0, y0, x1 - x0, y1 - y0) & cv::Rect(0, 0, view_size.width, view_size.height);
}

void paint_object(const ObjectMask& object, std::uint8_t label, cv::Mat& labels) {
  constexpr int step = DepthView::step;
  for (int y = 0; y < object.area.height; ++y) {
    for (int x = 0; x < object.area.width; ++x) {
      if (object.mask.at<std::uint8_t>(y, x) == 0) continue;
      const cv::Rect pixels = cv::Rect((x + object.area.x) * step, (y + object.area.y) * step, step,
                                       step) &
                              cv::Rect(0, 0, labels.cols, labels.rows);
      labels(pixels) = label;
    }
  }
}

ObjectMask cluster_object(const DepthView& view, const cv::Mat& planes, const cv::Rect2f& box,
                          const ObjectPrior& prior, const ClusteringOptions& options,
                          std::uint64_t seed) {
  ObjectMask out;
  const cv::Rect inner = view_rect(box, view.depth.size());
  constexpr int min_side = 3;  // pixels of the view
  if (inner.width < min_side || inner.height < min_side) return out;
  const bool literal = options.mode == ClusteringMode::paper;
  const cv::Mat no_planes;
  const cv::Mat& used_planes = literal || !options.remove_planes ? no_planes : planes;
  const DepthHistogram histogram = histogram_of(view, used_planes, inner);
  float mean_depth = prior.mean_depth, share = prior.share;
  if (mean_depth <= 0.0F) {
    mean_depth = dominant_near_mode(histogram_of(view, used_planes, central_half(inner)),
                                    options.first_mode_share, 2.0 * options.join_distance);
    constexpr float typical_share = 0.5F;  // a person fills about half of the box
    share = typical_share;
  }
  if (mean_depth <= 0.0F) return out;
  const DepthInterval interval =
      object_interval(histogram, mean_depth, share, options, seed, &out.clusters);

  out.area = literal ? inner : grown(inner, options.growth, view.depth.size());
  cv::Mat candidates(out.area.size(), CV_8UC1);
  for (int y = 0; y < out.area.height; ++y) {
    for (int x = 0; x < out.area.width; ++x) {
      const float z = view.depth.at<float>(y + out.area.y, x + out.area.x);
      candidates.at<std::uint8_t>(y, x) =
          interval.holds(z) && !flagged(used_planes, x + out.area.x, y + out.area.y) ? 255 : 0;
    }
  }
  const cv::Rect inner_in_area(inner.x - out.area.x, inner.y - out.area.y, inner.width,
                               inner.height);
  out.mask = cv::Mat::zeros(out.area.size(), CV_8UC1);
  candidates(inner_in_area).copyTo(out.mask(inner_in_area));
  const int side = 2 * options.opening + 1;
  cv::morphologyEx(out.mask, out.mask, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_RECT, {side, side}), {-1, -1}, 1,
                   cv::BORDER_REPLICATE);
  drop_small_blobs(out.mask, options.min_blob_share);
  if (!literal) grow_over_surface(view, out.area, candidates, options, out.mask);

  double sum = 0.0;
  int count = 0, inside = 0;
  for (int y = 0; y < out.area.height; ++y) {
    for (int x = 0; x < out.area.width; ++x) {
      if (out.mask.at<std::uint8_t>(y, x) == 0) continue;
      sum += static_cast<double>(view.depth.at<float>(y + out.area.y, x + out.area.x));
      ++count;
      inside += inner_in_area.contains({x, y}) ? 1 : 0;
    }
  }
  int known = 0;
  for (int y = inner.y; y < inner.y + inner.height; ++y) {
    const float* row = view.depth.ptr<float>(y);
    known += static_cast<int>(
        std::count_if(row + inner.x, row + inner.x + inner.width, [](float z) { return z > 0; }));
  }
  if (count == 0 || known == 0) return out;
  out.mean_depth = static_cast<float>(sum / count);
  out.share = static_cast<float>(inside) / static_cast<float>(known);
  return out;
}

}  // namespace dkp_slam
