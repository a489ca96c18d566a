#include "dkp_slam/sensor/synthetic/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Nearer parts of a surface (metres) are cut off before it is projected; nothing comes so near.
constexpr double near_plane = 0.02;
// World frame: a lamp under the ceiling and a weak one where a window would be.
const Vector3d lamp(0.3, 0.4, 2.6), window(-2.6, -0.8, 1.8);
constexpr double ambient = 0.50, lamp_strength = 0.42, window_strength = 0.18;

/// A panel in the camera frame with what its intersection needs for every pixel.
struct PreparedPanel {
  Panel panel;
  Vector3d normal, u, v;  ///< u, v: edges over their squared length
  double k, u0, v0;

  explicit PreparedPanel(const Panel& p)
      : panel(p),
        normal(p.normal()),
        u(p.edge_u / p.edge_u.squaredNorm()),
        v(p.edge_v / p.edge_v.squaredNorm()),
        k(normal.dot(p.origin)),
        u0(u.dot(p.origin)),
        v0(v.dot(p.origin)) {}

  Vector2d uv(const Vector3d& ray) const {
    const double t = k / normal.dot(ray);
    return {t * u.dot(ray) - u0, t * v.dot(ray) - v0};
  }
  /// Depth along z (rays have z = 1), or infinity.
  double depth(const Vector3d& ray) const {
    const double t = k / normal.dot(ray);
    const double a = t * u.dot(ray) - u0, b = t * v.dot(ray) - v0;
    const bool hit = t > 0.0 && a >= 0.0 && a <= 1.0 && b >= 0.0 && b <= 1.0;
    return hit ? t : std::numeric_limits<double>::infinity();
  }
};

struct Hit {
  double depth = std::numeric_limits<double>::infinity();
  int shape = -1;
};

/// The world as one camera at one time sees it.
class View {
 public:
  View(const Camera& camera, const Se3& camera_from_world) : camera_(camera) {
    lamp_ = camera_from_world * lamp;
    window_ = camera_from_world * window;
  }

  /// All panels come before the first solid: shapes are numbered in this order.
  void add(const Panel& panel) {
    const cv::Rect box = bounds(panel);
    if (box.empty()) return;
    panels_.emplace_back(panel);
    boxes_.push_back(box);
  }
  void add(const Solid& solid) {
    const cv::Rect box = bounds(solid);
    if (box.empty()) return;
    solids_.push_back(solid);
    boxes_.push_back(box);
  }

  bool is_person(int shape) const { return shape >= static_cast<int>(panels_.size()); }

  Vector3d ray(double x, double y) const {
    return {(x - camera_.cx) / camera_.fx, (y - camera_.cy) / camera_.fy, 1.0};
  }

  /// Nearest shape at the centre of every pixel of a row.
  void trace_row(int y, std::vector<Hit>* hits) const {
    hits->assign(static_cast<std::size_t>(camera_.width), Hit());
    std::vector<Vector3d> rays;
    for (int x = 0; x < camera_.width; ++x) rays.push_back(ray(x, y));
    for (int shape = 0; shape < static_cast<int>(boxes_.size()); ++shape) {
      const cv::Rect& box = boxes_[static_cast<std::size_t>(shape)];
      if (y < box.y || y >= box.br().y) continue;
      for (int x = box.x; x < box.br().x; ++x) {
        Hit& hit = (*hits)[static_cast<std::size_t>(x)];
        const double depth = depth_of(shape, rays[static_cast<std::size_t>(x)]);
        if (depth < hit.depth) hit = {depth, shape};
      }
    }
  }

  /// Nearest shape for a ray through pixel `at` or its surroundings.
  Hit trace(const Vector3d& ray, const cv::Point& at) const {
    Hit hit;
    for (int shape = 0; shape < static_cast<int>(boxes_.size()); ++shape) {
      if (!boxes_[static_cast<std::size_t>(shape)].contains(at)) continue;
      const double depth = depth_of(shape, ray);
      if (depth < hit.depth) hit = {depth, shape};
    }
    return hit;
  }

  cv::Vec3f colour(const Hit& hit, const Vector3d& ray) const {
    if (hit.shape < 0) return {0.0F, 0.0F, 0.0F};
    const Vector3d point = hit.depth * ray;
    const Vector3d right(1.0 / camera_.fx, 0.0, 0.0), down(0.0, 1.0 / camera_.fy, 0.0);
    if (!is_person(hit.shape)) {
      const PreparedPanel& p = panels_[static_cast<std::size_t>(hit.shape)];
      const Vector2d uv = p.uv(ray);
      return p.panel.texture->sample(uv, p.uv(ray + right) - uv, p.uv(ray + down) - uv) *
             light(point, p.normal);
    }
    const Solid& s = solids_[static_cast<std::size_t>(hit.shape) - panels_.size()];
    const Vector3d normal = s.normal_at(point);
    // At the silhouette the footprint grows without bound; a fifth of the slope is enough there.
    const double slope = std::max(std::abs(normal.dot(ray.normalized())), 0.2);
    const double footprint = hit.depth / (camera_.fx * slope);
    const Vector2d size = s.texture_size();
    return s.texture->sample(s.uv_at(point), Vector2d(footprint / size.x(), 0.0),
                             Vector2d(0.0, footprint / size.y())) *
           light(point, normal);
  }

 private:
  double depth_of(int shape, const Vector3d& ray) const {
    if (!is_person(shape)) return panels_[static_cast<std::size_t>(shape)].depth(ray);
    const auto t = intersect(solids_[static_cast<std::size_t>(shape) - panels_.size()], ray);
    return t ? *t : std::numeric_limits<double>::infinity();
  }

  /// Share of the light that a matt surface sends back; the same from every direction of view.
  float light(const Vector3d& point, const Vector3d& normal) const {
    const Vector3d facing = normal.dot(point) > 0.0 ? Vector3d(-normal) : normal;
    const auto from = [&](const Vector3d& source, double strength) {
      return strength * std::max(0.0, facing.dot((source - point).normalized()));
    };
    return static_cast<float>(ambient + from(lamp_, lamp_strength) +
                              from(window_, window_strength));
  }

  cv::Rect pixels(double left, double top, double right, double bottom) const {
    // One pixel more on each side for the extra rays of edge pixels. Clamped before the conversion:
    // surfaces beside the camera project to far beyond what an int holds.
    const auto clamp = [](double v, int size) {
      return static_cast<int>(std::clamp(v, -2.0, size + 2.0));
    };
    const int x0 = clamp(std::floor(left) - 1.0, camera_.width);
    const int y0 = clamp(std::floor(top) - 1.0, camera_.height);
    const int x1 = clamp(std::ceil(right) + 2.0, camera_.width);
    const int y1 = clamp(std::ceil(bottom) + 2.0, camera_.height);
    return cv::Rect(x0, y0, x1 - x0, y1 - y0) & cv::Rect(0, 0, camera_.width, camera_.height);
  }

  /// Pixels that can see the panel: its corners after cutting off what lies behind the camera.
  cv::Rect bounds(const Panel& p) const {
    const Vector3d corners[4] = {p.origin, p.origin + p.edge_u, p.origin + p.edge_u + p.edge_v,
                                 p.origin + p.edge_v};
    constexpr double inf = std::numeric_limits<double>::infinity();
    double left = inf, top = inf, right = -inf, bottom = -inf;
    const auto include = [&](const Vector3d& corner) {
      const Vector2d pixel = camera_.project(corner);
      left = std::min(left, pixel.x());
      right = std::max(right, pixel.x());
      top = std::min(top, pixel.y());
      bottom = std::max(bottom, pixel.y());
    };
    for (int i = 0; i < 4; ++i) {
      const Vector3d &a = corners[i], &b = corners[(i + 1) % 4];
      if (a.z() >= near_plane) include(a);
      if ((a.z() >= near_plane) != (b.z() >= near_plane)) {
        include(a + (near_plane - a.z()) / (b.z() - a.z()) * (b - a));
      }
    }
    return left > right ? cv::Rect() : pixels(left, top, right, bottom);
  }

  /// Pixels that can see a solid: those of a box around its ball.
  cv::Rect bounds(const Solid& s) const {
    const double r = s.bound();
    if (s.centre.z() + r <= near_plane) return {};
    const double nearest = s.centre.z() - r;
    if (nearest <= near_plane) return {0, 0, camera_.width, camera_.height};
    const auto low = [&](double c) { return c - r < 0.0 ? nearest : s.centre.z() + r; };
    const auto high = [&](double c) { return c + r > 0.0 ? nearest : s.centre.z() + r; };
    const double x = s.centre.x(), y = s.centre.y();
    return pixels(
        camera_.fx * (x - r) / low(x) + camera_.cx, camera_.fy * (y - r) / low(y) + camera_.cy,
        camera_.fx * (x + r) / high(x) + camera_.cx, camera_.fy * (y + r) / high(y) + camera_.cy);
  }

  const Camera& camera_;
  std::vector<PreparedPanel> panels_;
  std::vector<Solid> solids_;
  std::vector<cv::Rect> boxes_;  ///< of the panels, then of the solids
  Vector3d lamp_, window_;
};

/// Colours of one row. `shapes` is CV_32SC1: pixels whose neighbours show another shape are
/// averaged over several rays.
void shade_row(const View& view, int y, const std::vector<Hit>& hits, const cv::Mat& shapes,
               cv::Mat* colour) {
  // A rotated grid: four rays that share no row and no column of the pixel.
  constexpr double offsets[4][2] = {
      {-0.125, -0.375}, {0.375, -0.125}, {-0.375, 0.125}, {0.125, 0.375}};
  const int* row = shapes.ptr<int>(y);
  const int* above = shapes.ptr<int>(std::max(y - 1, 0));
  const int* below = shapes.ptr<int>(std::min(y + 1, shapes.rows - 1));
  for (int x = 0; x < shapes.cols; ++x) {
    const int left = row[std::max(x - 1, 0)], right = row[std::min(x + 1, shapes.cols - 1)];
    const int here = row[x];
    cv::Vec3f bgr(0.0F, 0.0F, 0.0F);
    if (left == here && right == here && above[x] == here && below[x] == here) {
      bgr = view.colour(hits[static_cast<std::size_t>(x)], view.ray(x, y));
    } else {
      for (const auto& offset : offsets) {
        const Vector3d ray = view.ray(x + offset[0], y + offset[1]);
        bgr += 0.25F * view.colour(view.trace(ray, {x, y}), ray);
      }
    }
    auto& out = colour->at<cv::Vec3b>(y, x);
    for (int c = 0; c < 3; ++c) out[c] = cv::saturate_cast<std::uint8_t>(bgr[c]);
  }
}

}  // namespace

SyntheticWorld::SyntheticWorld(std::uint64_t seed, int people) {
  if (people < 0) throw Error("synthetic world: the number of people must be at least 0");
  // Two generators: the room of a seed is the same with any number of people in it.
  cv::RNG room_rng(seed * 2 + 1), people_rng(seed * 2 + 2);
  panels_ = build_room(room_rng);
  for (int i = 0; i < people; ++i) {
    WalkingLoop loop;
    // The first one enters from the side of the desk soon after the start, the others spread out.
    loop.start = 1.05 * std::numbers::pi + 2.0 * std::numbers::pi * i / people;
    people_.emplace_back(people_rng, loop);
  }
}

Rendering SyntheticWorld::render(const Camera& camera, const Se3& world_from_camera,
                                 double time) const {
  if (!camera.distortion.none()) {
    throw Error("synthetic world: cannot render lens distortion; set the distortion to 0");
  }
  const Se3 camera_from_world = world_from_camera.inverse();
  View view(camera, camera_from_world);
  for (const Panel& panel : panels_) view.add(camera_from_world * panel);
  for (const Person& person : people_) {
    for (const Solid& part : person.at(time)) view.add(camera_from_world * part);
  }

  Rendering out;
  out.colour.create(camera.height, camera.width, CV_8UC3);
  out.depth.create(camera.height, camera.width, CV_32FC1);
  out.mask.create(camera.height, camera.width, CV_8UC1);
  cv::Mat shapes(camera.height, camera.width, CV_32SC1);
  std::vector<std::vector<Hit>> hits(static_cast<std::size_t>(camera.height));
  const cv::Range rows(0, camera.height);
  cv::parallel_for_(rows, [&](const cv::Range& range) {
    for (int y = range.start; y < range.end; ++y) {
      auto& row = hits[static_cast<std::size_t>(y)];
      view.trace_row(y, &row);
      for (int x = 0; x < camera.width; ++x) {
        const Hit& hit = row[static_cast<std::size_t>(x)];
        shapes.at<int>(y, x) = hit.shape;
        out.depth.at<float>(y, x) = hit.shape < 0 ? 0.0F : static_cast<float>(hit.depth);
        out.mask.at<std::uint8_t>(y, x) = view.is_person(hit.shape) ? 255 : 0;
      }
    }
  });
  cv::parallel_for_(rows, [&](const cv::Range& range) {
    for (int y = range.start; y < range.end; ++y) {
      shade_row(view, y, hits[static_cast<std::size_t>(y)], shapes, &out.colour);
    }
  });
  return out;
}

}  // namespace dkp_slam
