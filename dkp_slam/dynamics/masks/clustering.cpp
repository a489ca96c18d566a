#include "dkp_slam/dynamics/masks/clustering.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/dynamics/masks/depth_interval.h"

namespace dkp_slam {
namespace {

constexpr float typical_share = 0.5F;  // a person fills about half of the box

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

cv::Rect grown(const cv::Rect& box, double share, const cv::Size& size) {
  const int dx = static_cast<int>(share * box.width), dy = static_cast<int>(share * box.height);
  return cv::Rect(box.x - dx, box.y - dy, box.width + 2 * dx, box.height + 2 * dy) &
         cv::Rect(0, 0, size.width, size.height);
}

/// A surface that reaches into an object's box; areas in pixels of the view.
struct Candidate {
  std::size_t segment = 0;
  int in_box = 0;    ///< of it in the box
  int in_grown = 0;  ///< of it in the box's grown surroundings
  int in_prior = 0;  ///< of it where the object's earlier silhouette went
};

std::vector<Candidate> find_candidates(const SegmentMap& surfaces, const cv::Rect& inner,
                                       const cv::Rect& outer, const ObjectPrior& prior) {
  std::vector<Candidate> found;
  std::vector<int> index(surfaces.segments.size(), -1);
  for_each_pixel(outer, [&](int x, int y) {
    const int label = surfaces.labels.at<int>(y, x);
    if (label == 0) return;
    int& i = index[static_cast<std::size_t>(label - 1)];
    if (i < 0) {
      i = static_cast<int>(found.size());
      found.push_back({static_cast<std::size_t>(label - 1)});
    }
    Candidate& c = found[static_cast<std::size_t>(i)];
    ++c.in_grown;
    if (inner.contains({x, y})) ++c.in_box;
    const cv::Point before = cv::Point(x, y) - prior.shift;
    if (!prior.mask.empty() && prior.mask.area.contains(before) &&
        prior.mask.mask.at<std::uint8_t>(before - prior.mask.area.tl()) != 0) {
      ++c.in_prior;
    }
  });
  return found;
}

double rect_iou(const cv::Rect& a, const cv::Rect& b) {
  const double common = (a & b).area();
  return common / std::max(1.0, a.area() + b.area() - common);
}

/// The surface that most looks like the object: large in the box, hardly outside it, filling the
/// box from side to side as a tight detection is filled, where the object was before, and moving
/// rather than proved still. -1 when there is none.
int main_candidate(const SegmentMap& surfaces, const std::vector<Candidate>& candidates,
                   const cv::Rect& inner, const ObjectPrior& prior,
                   const ClusteringOptions& options) {
  int best = -1;
  double best_score = 0.0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    const Segment& s = surfaces.segments[c.segment];
    if (s.large) continue;
    constexpr double min_fill = 0.03;  // of the box: less is a thing in a person's box
    if (c.in_box < min_fill * inner.area()) continue;
    const double overlap = static_cast<double>(c.in_prior) / c.in_grown;
    constexpr double followed = 0.3;  // of a carried object's surface must lie where it went
    if (prior.carried && overlap < followed) continue;
    double score = c.in_box * (static_cast<double>(c.in_grown) / s.area);
    score *= 0.3 + rect_iou(s.box, inner);
    if (s.proved_moving()) score *= 2.0;
    if (s.proved_still()) score *= 0.25;
    if (prior.mean_depth > 0.0F) {
      const double off =
          static_cast<double>(s.mean_depth - prior.mean_depth) / options.join_distance;
      score *= 0.3 + std::exp(-off * off) + overlap;
    }
    if (score > best_score) {
      best_score = score;
      best = static_cast<int>(i);
    }
  }
  if (best < 0) return -1;
  // A monitor or a wall in front of the person: better no mask than a wrong one.
  const Segment& winner = surfaces.segments[candidates[static_cast<std::size_t>(best)].segment];
  return winner.thing() ? -1 : best;
}

/// Adds the main surface and those that belong to it.
void paint_surfaces(const Scene& scene, const std::vector<Candidate>& candidates, int main,
                    const DepthInterval& interval, bool named, const ClusteringOptions& options,
                    ObjectMask& out) {
  const SegmentMap& surfaces = scene.surfaces;
  const int main_area = candidates[static_cast<std::size_t>(main)].in_grown;
  enum : std::uint8_t { no, in_interval, whole };
  std::vector<std::uint8_t> take(surfaces.segments.size(), no);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    const Segment& s = surfaces.segments[c.segment];
    const bool inside = c.in_grown >= options.inside_share * s.area;
    const bool large = c.in_grown >= options.min_blob_share * main_area;
    const bool known = 2 * c.in_prior > c.in_grown;
    if (static_cast<int>(i) == main) {
      take[c.segment] = inside ? whole : in_interval;
    } else if (!inside || s.proved_still() || s.thing()) {
      continue;
    } else if (named ? s.proved_surely_moving() : s.proved_moving()) {
      take[c.segment] = whole;  // a second person at another depth
    } else if (interval.holds(s.mean_depth) && (large || known) && c.in_box * 2 > c.in_grown) {
      take[c.segment] = in_interval;
    }
  }
  for_each_pixel(out.area, [&](int x, int y) {
    const int label = surfaces.labels.at<int>(y, x);
    if (label == 0) return;
    const std::uint8_t how = take[static_cast<std::size_t>(label - 1)];
    if (how == whole || (how == in_interval && interval.holds(scene.view.depth.at<float>(y, x)))) {
      out.mask.at<std::uint8_t>(y - out.area.y, x - out.area.x) = 255;
    }
  });
}

/// The crumbs' pixels of the area that the mask does not hold.
std::vector<cv::Point> crumb_pixels(const SegmentMap& surfaces, const ObjectMask& mask,
                                    int crumb_area) {
  std::vector<cv::Point> found;
  for_each_pixel(mask.area, [&](int x, int y) {
    const int label = surfaces.labels.at<int>(y, x);
    if (label == 0) return;
    if (surfaces.segments[static_cast<std::size_t>(label - 1)].area >= crumb_area) return;
    if (mask.mask.at<std::uint8_t>(y - mask.area.y, x - mask.area.x) == 0) found.emplace_back(x, y);
  });
  return found;
}

/// Lets the mask grow over crumbs, pixel by pixel.
void add_crumbs(const Scene& scene, const ClusteringOptions& options, ObjectMask& out) {
  const auto step = static_cast<float>(options.crumb_step);
  const cv::Mat& depth = scene.view.depth;
  const auto touches = [&](const cv::Point& p) {
    const float z = depth.at<float>(p);
    for (const cv::Point& d : {cv::Point(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
      const cv::Point q = p + d;
      if (!out.area.contains(q) || out.mask.at<std::uint8_t>(q - out.area.tl()) == 0) continue;
      if (std::abs(depth.at<float>(q) - z) <= step) return true;
    }
    return false;
  };
  std::vector<cv::Point> left = crumb_pixels(scene.surfaces, out, options.crumb_area);
  for (int round = 0; round < options.crumb_reach; ++round) {
    const auto added = std::partition(left.begin(), left.end(), std::not_fn(touches));
    for (auto p = added; p != left.end(); ++p) {
      out.mask.at<std::uint8_t>(*p - out.area.tl()) = 255;
    }
    left.erase(added, left.end());
  }
}

void open_mask(int radius, cv::Mat& mask) {
  const int side = 2 * radius + 1;
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_RECT, {side, side}), {-1, -1}, 1,
                   cv::BORDER_REPLICATE);
}

/// Algorithm 1 as it is printed; `inner` is the object's box in pixels of the view.
ObjectMask cluster_as_printed(const DepthView& view, const cv::Rect& inner,
                              const ObjectPrior& prior, const ClusteringOptions& options,
                              std::uint64_t seed) {
  float mean_depth = prior.mean_depth;
  if (mean_depth <= 0.0F) {
    mean_depth = dominant_near_mode(histogram_of(view, {}, central_half(inner)),
                                    options.first_mode_share, 2.0 * options.join_distance);
  }
  if (mean_depth <= 0.0F) return {};
  ObjectMask out;
  const DepthInterval interval = object_interval(histogram_of(view, {}, inner), mean_depth,
                                                 prior.share > 0.0F ? prior.share : typical_share,
                                                 options, seed, &out.clusters);
  out.area = inner;
  out.mask = cv::Mat::zeros(out.area.size(), CV_8UC1);
  for_each_pixel(out.area, [&](int x, int y) {
    if (interval.holds(view.depth.at<float>(y, x))) {
      out.mask.at<std::uint8_t>(y - out.area.y, x - out.area.x) = 255;
    }
  });
  open_mask(options.opening, out.mask);
  drop_small_blobs(out.mask, options.min_blob_share);
  measure_mask(view, inner, out);
  return out;
}

}  // namespace

Scene make_scene(const DepthView& view, double focal_length, const std::vector<Plane>& planes,
                 const ClusteringOptions& options, std::uint64_t seed) {
  Scene scene;
  scene.view = view;
  if (options.mode == ClusteringMode::paper) return scene;
  if (options.remove_planes) {
    const cv::Rect whole(0, 0, view.depth.cols, view.depth.rows);
    scene.planes = plane_pixels(view, planes, whole, options.planes);
  }
  scene.surfaces = segment_surfaces(view, scene.planes, options.segments);
  if (!options.remove_planes) return scene;
  const cv::Mat flat =
      find_flat_patches(view, scene.surfaces, focal_length, options.flat_patches, seed);
  if (cv::countNonZero(flat) > 0) {
    scene.planes |= flat;
    scene.surfaces = segment_surfaces(view, scene.planes, options.segments);
  }
  return scene;
}

ObjectMask cluster_object(const Scene& scene, const cv::Rect2f& box, const ObjectPrior& prior,
                          const ClusteringOptions& options, std::uint64_t seed) {
  const DepthView& view = scene.view;
  const cv::Rect inner = view_rect(box, view.depth.size());
  constexpr int min_side = 3;  // pixels of the view
  if (inner.width < min_side || inner.height < min_side) return {};
  if (options.mode == ClusteringMode::paper)
    return cluster_as_printed(view, inner, prior, options, seed);
  const cv::Rect outer = grown(inner, options.growth, view.depth.size());
  const std::vector<Candidate> candidates = find_candidates(scene.surfaces, inner, outer, prior);
  const int main = main_candidate(scene.surfaces, candidates, inner, prior, options);
  if (main < 0) return {};
  ObjectMask out;
  const Segment& surface =
      scene.surfaces.segments[candidates[static_cast<std::size_t>(main)].segment];
  out.moving = surface.proved_moving();
  out.still = surface.proved_still();
  float mean_depth = prior.mean_depth, share = prior.share;
  // A prior that the main surface contradicts was about something else.
  if (std::abs(surface.mean_depth - mean_depth) > static_cast<float>(options.join_distance)) {
    mean_depth = surface.mean_depth;
    share = 0.0F;
  }
  if (mean_depth <= 0.0F) return out;
  const DepthInterval interval =
      object_interval(histogram_of(view, scene.planes, inner), mean_depth,
                      share > 0.0F ? share : typical_share, options, seed, &out.clusters);
  out.area = outer;
  out.mask = cv::Mat::zeros(out.area.size(), CV_8UC1);
  paint_surfaces(scene, candidates, main, interval, prior.named, options, out);
  open_mask(options.opening, out.mask);
  add_crumbs(scene, options, out);
  measure_mask(view, inner, out);
  return out;
}

}  // namespace dkp_slam
