#include "dkp_slam/dynamics/masks/flat_patches.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/dynamics/masks/object_mask.h"
#include "dkp_slam/geometry/planes/plane.h"
#include "dkp_slam/geometry/ransac.h"

namespace dkp_slam {
namespace {

class PatchFinder {
 public:
  PatchFinder(const DepthView& view, const SegmentMap& map, int label,
              const FlatPatchOptions& options, std::uint64_t seed)
      : view_(view), map_(map), label_(label), options_(options), random_(seed) {
    const cv::Rect& box = map.segments[static_cast<std::size_t>(label - 1)].box;
    constexpr int stride = 3;
    for (int y = box.y + 1; y < box.y + box.height; y += stride) {
      for (int x = box.x + 1; x < box.x + box.width; x += stride) {
        if (map.labels.at<int>(y, x) == label) samples_.push_back({{x, y}, view.point(x, y)});
      }
    }
    fill_counter();
  }

  /// The plane with the most samples, flat or cut through a body; their share is a ninth of its
  /// pixels.
  std::optional<Plane> best(int min_samples) {
    if (samples_.empty()) return std::nullopt;
    // A start may hold less than the patch before it is refined.
    const auto found = ransac<Plane>(*this, options_.iterations, min_samples / 4);
    if (!found.model || found.score < min_samples) return std::nullopt;
    return found.model;
  }

  /// For `ransac`: a plane through three pixels some way apart. Near ones are noise, far ones other
  /// things.
  std::optional<Plane> sample() {
    constexpr int reach = 25;  // pixels of the view
    const Sample& a = samples_[random_() % samples_.size()];
    const auto offset = [&] { return static_cast<int>(random_() % (2 * reach + 1)) - reach; };
    Eigen::Vector3f corner[2];
    for (Eigen::Vector3f& c : corner) {
      const cv::Point p = a.pixel + cv::Point(offset(), offset());
      if (!cv::Rect(0, 0, map_.labels.cols, map_.labels.rows).contains(p)) return std::nullopt;
      if (map_.labels.at<int>(p) != label_) return std::nullopt;
      c = view_.point(p.x, p.y);
    }
    return plane_through(a.point, corner[0], corner[1]);
  }

  int score(const Plane& plane, int /*best*/) const { return counter_.count(plane); }

  /// Three pixels fix a plane near by only: least squares carry it to the patch's far end.
  void refine(Plane& plane, int& count) const {
    for (int step = 0; step < 3; ++step) {
      const Plane refined = fit_plane(inliers(plane));
      const int more = counter_.count(refined);
      if (more <= count) break;
      count = more;
      plane = refined;
    }
  }

  /// Within `factor` times the half thickness.
  bool holds(const Plane& plane, const Eigen::Vector3f& p, float factor = 1.0F) const {
    return std::abs(plane.normal.dot(p) - plane.distance) < factor * half_thickness(p.z());
  }

  /// Whether what lies on the plane ends there, and is no rest of something round whose middle was
  /// passed over.
  bool is_flat(const Plane& plane) const {
    constexpr float edge_on = 0.3F;  // cosine: seen more from the side nothing can be told
    return std::abs(plane.normal.z()) >= edge_on && !is_rest(plane) &&
           widening(plane) <= options_.max_widening;
  }

  /// What lies on a patch is looked at no more.
  void take(const Plane& plane) {
    const auto on_it = [&](const Sample& s) { return holds(plane, s.point); };
    std::erase_if(samples_, on_it);
    std::erase_if(passed_, on_it);
    taken_.push_back(plane);
    fill_counter();
  }
  /// No other plane is looked for there, but another may still widen to it.
  void pass_over(const Plane& plane) {
    std::erase_if(samples_, [&](const Sample& s) {
      if (!holds(plane, s.point)) return false;
      passed_.push_back(s);
      return true;
    });
    fill_counter();
  }

 private:
  struct Sample {
    cv::Point pixel;
    Eigen::Vector3f point;
  };

  float half_thickness(float z) const {
    return static_cast<float>(options_.thickness_constant + options_.thickness_quadratic * z * z);
  }

  /// Whether much of what lies on the plane was passed over with another.
  bool is_rest(const Plane& plane) const {
    constexpr double most = 0.1;
    const auto passed = std::count_if(passed_.begin(), passed_.end(),
                                      [&](const Sample& s) { return holds(plane, s.point); });
    return static_cast<double>(passed) > most * static_cast<double>(passed + counter_.count(plane));
  }

  /// Pixels on the plane at twice the thickness over those at the thickness, but for those that
  /// were taken; of all pixels and not of samples, between whose columns the edge of a narrow band
  /// would not be seen to move.
  double widening(const Plane& plane) const {
    int on = 0, about = 0;
    for_each_pixel(map_.segments[static_cast<std::size_t>(label_ - 1)].box, [&](int x, int y) {
      if (map_.labels.at<int>(y, x) != label_) return;
      const Eigen::Vector3f p = view_.point(x, y);
      if (!holds(plane, p, 2.0F)) return;
      for (const Plane& other : taken_) {
        if (holds(other, p)) return;
      }
      ++about;
      on += holds(plane, p) ? 1 : 0;
    });
    return static_cast<double>(about) / std::max(1, on);
  }

  void fill_counter() {
    counter_ = {};
    for (const Sample& s : samples_) counter_.add(s.point, half_thickness(s.point.z()));
  }

  std::vector<Eigen::Vector3f> inliers(const Plane& plane) const {
    std::vector<Eigen::Vector3f> points;
    for (const Sample& s : samples_) {
      if (holds(plane, s.point)) points.push_back(s.point);
    }
    return points;
  }

  const DepthView& view_;
  const SegmentMap& map_;
  int label_;
  const FlatPatchOptions& options_;
  std::mt19937_64 random_;
  std::vector<Sample> samples_;
  InlierCounter counter_;       // of the samples
  std::vector<Sample> passed_;  // no plane is looked for in these any more
  std::vector<Plane> taken_;
};

/// The pixels of a segment that lie on a plane in pieces of `min_pixels` at least, CV_8UC1 of its
/// box's size.
cv::Mat pieces_on(const Plane& plane, const PatchFinder& finder, const DepthView& view,
                  const SegmentMap& map, int label, int min_pixels) {
  const cv::Rect& box = map.segments[static_cast<std::size_t>(label - 1)].box;
  cv::Mat patch = cv::Mat::zeros(box.size(), CV_8UC1);
  for_each_pixel(box, [&](int x, int y) {
    if (map.labels.at<int>(y, x) == label && finder.holds(plane, view.point(x, y))) {
      patch.at<std::uint8_t>(y - box.y, x - box.x) = 255;
    }
  });
  // Where a plane cuts through a body it leaves stripes: the opening drops them.
  cv::Mat core, labels, stats, centroids, out = cv::Mat::zeros(box.size(), CV_8UC1);
  const cv::Mat square = cv::getStructuringElement(cv::MORPH_RECT, {7, 7});
  cv::morphologyEx(patch, core, cv::MORPH_OPEN, square);
  const int blobs = cv::connectedComponentsWithStats(core, labels, stats, centroids, 8, CV_16U);
  for (int b = 1; b < blobs; ++b) {
    if (stats.at<int>(b, cv::CC_STAT_AREA) < min_pixels) continue;
    cv::Mat blob = labels == b;
    cv::dilate(blob, blob, cv::getStructuringElement(cv::MORPH_RECT, {5, 5}));
    out.setTo(255, blob);
  }
  return out;
}

/// The flat patches of one segment, CV_8UC1 of its box's size; empty when there is none.
cv::Mat patches_of(const DepthView& view, const SegmentMap& map, int label, int min_pixels,
                   const FlatPatchOptions& options, std::uint64_t seed) {
  PatchFinder finder(view, map, label, options, seed);
  cv::Mat out;
  constexpr int pixels_per_sample = 9;
  for (int n = 0; n < options.max_per_segment; ++n) {
    const auto plane = finder.best(std::max(8, min_pixels / pixels_per_sample));
    if (!plane) break;
    if (finder.is_flat(*plane)) {
      const cv::Mat pieces = pieces_on(*plane, finder, view, map, label, min_pixels);
      if (out.empty()) {
        out = pieces;
      } else {
        out |= pieces;
      }
      finder.take(*plane);
    } else {
      finder.pass_over(*plane);
    }
  }
  return out;
}

}  // namespace

cv::Mat find_flat_patches(const DepthView& view, const SegmentMap& map, double focal_length,
                          const FlatPatchOptions& options, std::uint64_t seed) {
  std::vector<cv::Mat> patches(map.segments.size());
  // Each segment has its own seed and place for the result: the threads' order does not matter.
  cv::parallel_for_({0, static_cast<int>(patches.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const Segment& s = map.segments[static_cast<std::size_t>(i)];
      const double z = static_cast<double>(s.mean_depth);
      const double pixel_side = z * DepthView::step / focal_length;
      const auto min_pixels = static_cast<int>(options.min_area / (pixel_side * pixel_side));
      if (z > options.max_depth || s.area < 2 * min_pixels) continue;
      patches[static_cast<std::size_t>(i)] =
          patches_of(view, map, i + 1, min_pixels, options, seed + static_cast<std::uint64_t>(i));
    }
  });
  cv::Mat out = cv::Mat::zeros(view.depth.size(), CV_8UC1);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (!patches[i].empty()) out(map.segments[i].box) |= patches[i];
  }
  return out;
}

}  // namespace dkp_slam
