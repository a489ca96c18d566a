#include "dkp_slam/dynamics/masks/static_background.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/config/option_list.h"

namespace dkp_slam {
namespace {

constexpr int cell = 2;  // pixels of the view

cv::Mat disc(int radius) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1));
}

std::uint8_t grey_at(const cv::Mat& grey, int x, int y) {
  return grey.at<std::uint8_t>(y * DepthView::step, x * DepthView::step);
}

}  // namespace

void StaticBackgroundOptions::describe(OptionList& list) {
  list.add("tolerance_constant", tolerance_constant, at_least(0), "metres",
           "between depths of one surface, at no depth");
  list.add("tolerance_quadratic", tolerance_quadratic, at_least(0), "1/metre",
           "tolerance that depth squared adds");
  list.add("front", front, at_least(0), "metres", "from which on something is in front of it");
  list.add("grey_difference", grey_difference, at_least(0), "grey levels",
           "by which the same surface may look different");
  list.add("proof", proof, at_least(0), "seconds", "for which a surface must have stood still");
  list.add("memory", memory, at_least(0), "seconds", "that what is hidden is remembered");
  list.add("opening", opening, between(0, 50), "pixels of the view",
           "smaller pieces of background stay in a mask");
}

void StaticBackgroundOptions::check() const { check_options(*this); }

StaticBackground::StaticBackground(const Camera& camera, const StaticBackgroundOptions& options)
    : options_(options) {
  const cv::Mat rays = depth_view_rays(camera);
  constexpr float scale = 1.0F / static_cast<float>(DepthView::step * cell);
  fx_ = scale * static_cast<float>(camera.fx);
  fy_ = scale * static_cast<float>(camera.fy);
  cx_ = scale * static_cast<float>(camera.cx);
  cy_ = scale * static_cast<float>(camera.cy);
  grid_ = cv::Size(rays.cols / cell, rays.rows / cell);
  points_.resize(static_cast<std::size_t>(grid_.area()));
  cells_.create(rays.size(), CV_32SC1);
  for (int y = 0; y < rays.rows; ++y) {
    for (int x = 0; x < rays.cols; ++x) {
      const auto& ray = rays.at<cv::Vec2f>(y, x);
      cells_.at<int>(y, x) = cell_of({ray[0], ray[1], 1.0F});
    }
  }
}

int StaticBackground::cell_of(const Eigen::Vector3f& p) const {
  const int x = cvFloor(fx_ * p.x() / p.z() + cx_), y = cvFloor(fy_ * p.y() / p.z() + cy_);
  if (x < 0 || y < 0 || x >= grid_.width || y >= grid_.height) return -1;
  return y * grid_.width + x;
}

float StaticBackground::tolerance(float depth) const {
  return static_cast<float>(options_.tolerance_constant +
                            options_.tolerance_quadratic * depth * depth);
}

void StaticBackground::forget() {
  std::fill(points_.begin(), points_.end(), Point{});
  proven_.current = false;
}

void StaticBackground::move(const Se3& current_from_previous) {
  const Eigen::Matrix3f R = current_from_previous.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = current_from_previous.translation.cast<float>();
  proven_.current = false;
  moved_.assign(points_.size(), Point{});
  constexpr float nearest = 0.1F;  // metres
  for (const Point& p : points_) {
    if (p.at.z() <= 0.0F) continue;
    Point q = p;
    q.at = R * p.at + t;
    if (q.at.z() < nearest) continue;
    const int c = cell_of(q.at);
    if (c < 0) continue;
    Point& there = moved_[static_cast<std::size_t>(c)];
    if (there.at.z() <= 0.0F || q.at.z() < there.at.z()) there = q;
  }
  points_.swap(moved_);
}

/// The points that stood still for long enough, in rows that a pixel's neighbourhood is read from
/// at once: with an empty row of the grid before the first and after the last.
void StaticBackground::list_proven() {
  if (proven_.current) return;
  proven_.current = true;
  const auto width = static_cast<std::size_t>(grid_.width);
  const std::size_t size = points_.size() + 2 * width;
  proven_.depth.assign(size, 0.0F);
  proven_.grey.assign(size, 0);
  proven_.nearest.assign(size, std::numeric_limits<float>::infinity());
  proven_.farthest.assign(size, -std::numeric_limits<float>::infinity());
  for (std::size_t c = 0; c < points_.size(); ++c) {
    const Point& p = points_[c];
    const float z = p.at.z();
    if (z <= 0.0F || p.seen - p.since < options_.proof) continue;
    const std::size_t here = c + width;
    proven_.depth[here] = z;
    proven_.grey[here] = p.grey;
    for (const std::size_t near : {here, here - 1, here + 1, here - width, here + width}) {
      proven_.nearest[near] = std::min(proven_.nearest[near], z);
      proven_.farthest[near] = std::max(proven_.farthest[near], z);
    }
  }
}

/// Whether one of the points about a cell is a surface at depth z that looks alike.
bool StaticBackground::is_known(std::size_t cell, float z, float same, std::uint8_t grey) const {
  const auto width = static_cast<std::size_t>(grid_.width);
  for (const std::size_t near : {cell, cell - 1, cell + 1, cell - width, cell + width}) {
    const float p = proven_.depth[near];
    if (p > 0.0F && std::abs(p - z) < same &&
        std::abs(int{proven_.grey[near]} - int{grey}) <= options_.grey_difference) {
      return true;
    }
  }
  return false;
}

void StaticBackground::compare(const DepthView& view, const cv::Mat& grey, const cv::Rect& area,
                               cv::Mat& known, cv::Mat* in_front) {
  list_proven();
  known = cv::Mat::zeros(area.size(), CV_8UC1);
  if (in_front) *in_front = cv::Mat::zeros(area.size(), CV_8UC1);
  for_each_pixel(area, [&](int x, int y) {
    const float z = view.depth.at<float>(y, x);
    const int c = cells_.at<int>(y, x);
    if (z <= 0.0F || c < 0) return;
    const auto cell = static_cast<std::size_t>(c + grid_.width);
    const float nearest = proven_.nearest[cell] - z, farthest = proven_.farthest[cell] - z;
    if (farthest < nearest) return;  // nothing is known about it
    const float same = tolerance(z);
    if (nearest > static_cast<float>(options_.front) + same) {
      if (in_front) in_front->at<std::uint8_t>(y - area.y, x - area.x) = 255;
    } else if (nearest < same && farthest > -same && is_known(cell, z, same, grey_at(grey, x, y))) {
      known.at<std::uint8_t>(y - area.y, x - area.x) = 255;
    }
  });
  // Thin bands are where somebody touches what is known, and the edges of steps.
  for (cv::Mat* pieces : {&known, in_front}) {
    if (pieces) cv::morphologyEx(*pieces, *pieces, cv::MORPH_OPEN, disc(options_.opening));
  }
}

cv::Mat StaticBackground::known(const DepthView& view, const cv::Mat& grey) {
  cv::Mat known;
  compare(view, grey, cv::Rect({0, 0}, view.depth.size()), known, nullptr);
  return known;
}

/// Takes what is known out of a mask, and what is then left of its rim.
void StaticBackground::cut_known(const cv::Mat& known, cv::Mat& mask) const {
  cv::Mat cut = mask & known;
  if (cv::countNonZero(cut) == 0) return;
  mask.setTo(0, cut);
  cv::Mat thick, near;
  cv::morphologyEx(mask, thick, cv::MORPH_OPEN, disc(options_.opening));
  cv::dilate(cut, near, disc(2 * options_.opening));
  mask.setTo(0, near & ~thick);
}

void StaticBackground::correct(const DepthView& view, const cv::Mat& grey, const cv::Rect2f& box,
                               ObjectMask& mask) {
  if (mask.empty()) return;
  const cv::Rect inside = view_rect(box, view.depth.size());
  const cv::Rect area = mask.area | inside;
  cv::Mat known, in_front;
  compare(view, grey, area, known, &in_front);
  cv::Mat whole = cv::Mat::zeros(area.size(), CV_8UC1);
  mask.mask.copyTo(whole(mask.area - area.tl()));
  cut_known(known, whole);
  const cv::Rect part = inside - area.tl();
  whole(part).setTo(255, in_front(part));
  mask.area = area;
  mask.mask = whole;
  // Depth and share stay those of the clusters, which the next frame's begin with.
  if (cv::countNonZero(whole) == 0) mask = {};
}

/// Since when a surface has stood there that shifted by a cell as it was carried along.
double StaticBackground::since_beside(int c, float z, double time) const {
  double since = time;
  for (const int step : {-1, 1, -grid_.width, grid_.width}) {
    if (c + step < 0 || c + step >= static_cast<int>(points_.size())) continue;
    const Point& p = points_[static_cast<std::size_t>(c + step)];
    if (p.at.z() > 0.0F && std::abs(p.at.z() - z) < tolerance(z)) since = std::min(since, p.since);
  }
  return since;
}

void StaticBackground::learn(const DepthView& view, const cv::Mat& grey,
                             const std::vector<cv::Rect2f>& hidden, double time) {
  proven_.current = false;
  cv::Mat free(view.depth.size(), CV_8UC1, cv::Scalar(255));
  constexpr float margin = 16.0F;  // pixels
  for (const cv::Rect2f& box : hidden) {
    const cv::Rect2f wide(box.tl() - cv::Point2f(margin, margin),
                          box.size() + cv::Size2f(2 * margin, 2 * margin));
    free(view_rect(wide, free.size())).setTo(0);
  }
  for (int y = 0; y < view.depth.rows; y += cell) {
    for (int x = 0; x < view.depth.cols; x += cell) {
      const int c = cells_.at<int>(y, x);
      const float z = view.depth.at<float>(y, x);
      if (c < 0 || z <= 0.0F) continue;
      Point& p = points_[static_cast<std::size_t>(c)];
      const float further = p.at.z() - z;
      if (free.at<std::uint8_t>(y, x) == 0) {
        const bool seen_through = further < -static_cast<float>(options_.front) - tolerance(z);
        if (p.at.z() > 0.0F && seen_through) p = {};
        continue;
      }
      const bool same = p.at.z() > 0.0F && std::abs(further) < tolerance(z);
      if (!same) p.since = since_beside(c, z, time);
      p.at = view.point(x, y);
      p.seen = time;
      p.grey = grey_at(grey, x, y);
    }
  }
  for (Point& p : points_) {
    if (time - p.seen > options_.memory) p = {};
  }
}

}  // namespace dkp_slam
