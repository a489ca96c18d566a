#include "dkp_slam/geometry/planes/plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <random>

#include <Eigen/Dense>
#include <opencv2/core/utility.hpp>

#include "dkp_slam/config/option_list.h"
#include "dkp_slam/geometry/ransac.h"

namespace dkp_slam {
namespace {

float half_thickness(float z, const PlaneOptions& options) {
  return static_cast<float>(options.thickness_constant + options.thickness_quadratic * z * z);
}

/// Extent and width take the points as spread evenly.
Plane least_squares(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d q = p.cast<double>();
    mean += q;
    moment += q * q.transpose();
  }
  const auto count = static_cast<double>(points.size());
  mean /= count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moment / count -
                                                              mean * mean.transpose());
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  const double extent = std::sqrt(12.0 * std::max(0.0, solver.eigenvalues()[2]));
  const double width = std::sqrt(12.0 * std::max(0.0, solver.eigenvalues()[1]));
  return {normal.cast<float>(), static_cast<float>(normal.dot(mean)), static_cast<float>(extent),
          static_cast<float>(width)};
}

/// A plane that runs through the camera, or nearly so, is no surface that it sees: it joins things.
bool seen_edge_on(const Plane& plane, const std::vector<Eigen::Vector3f>& points) {
  constexpr float least = 0.05F;  // of the points' mean distance: the sine of 3 degrees
  float sum = 0.0F;
  for (const Eigen::Vector3f& p : points) sum += p.norm();
  return std::abs(plane.distance) * static_cast<float>(points.size()) < least * sum;
}

/// The plane that most of the points lie on, for `ransac`.
class LargestPlane {
 public:
  LargestPlane(const std::vector<Eigen::Vector3f>& points, const PlaneOptions& options,
               std::mt19937_64& random)
      : points_(points), random_(random) {
    for (const Eigen::Vector3f& p : points) counter_.add(p, half_thickness(p.z(), options));
  }

  std::optional<Plane> sample() {
    const auto& a = points_[random_() % points_.size()];
    const auto& b = points_[random_() % points_.size()];
    const auto& c = points_[random_() % points_.size()];
    return plane_through(a, b, c);
  }

  int score(const Plane& plane, int /*best*/) const { return counter_.count(plane); }

 private:
  const std::vector<Eigen::Vector3f>& points_;
  std::mt19937_64& random_;
  InlierCounter counter_;
};

/// Points of the view and the pixels they are seen at.
struct Samples {
  std::vector<Eigen::Vector3f> points;
  std::vector<cv::Point> pixels;
};

Samples sample_points(const DepthView& view, const cv::Mat& exclude) {
  constexpr int stride = 6;  // about 2,000 points of a 640x480 image
  Samples samples;
  for (int y = stride / 2; y < view.depth.rows; y += stride) {
    for (int x = stride / 2; x < view.depth.cols; x += stride) {
      if (view.depth.at<float>(y, x) <= 0.0F) continue;
      if (!exclude.empty() && exclude.at<std::uint8_t>(y, x) != 0) continue;
      samples.points.push_back(view.point(x, y));
      samples.pixels.emplace_back(x, y);
    }
  }
  return samples;
}

/// Those that lie on a plane, or those that do not.
Samples points_on(const Samples& samples, const Plane& plane, const PlaneOptions& options,
                  bool on) {
  Samples out;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    if (lies_on(plane, samples.points[i], options) != on) continue;
    out.points.push_back(samples.points[i]);
    out.pixels.push_back(samples.pixels[i]);
  }
  return out;
}

/// A plane that cuts through things has points on it, but their surfaces do not run along it.
bool cuts_through(const DepthView& view, const Plane& plane, const std::vector<cv::Point>& pixels,
                  const PlaneOptions& options) {
  const auto along = std::count_if(pixels.begin(), pixels.end(), [&](const cv::Point& p) {
    return runs_along(view, plane, p.x, p.y, options);
  });
  return static_cast<double>(along) < options.min_along * static_cast<double>(pixels.size());
}

/// 0 in `near` for the pixels of row y that are farther off the plane than lies_on allows for, as
/// most are: sorts them out at the least cost. (By value what the loop needs: so the compiler takes
/// several pixels at a time.)
void mark_near(const DepthView& view, const Plane& plane, int y, const PlaneOptions& options,
               std::vector<std::uint8_t>& near) {
  const auto constant = static_cast<float>(options.thickness_constant + options.removal_margin);
  const auto quadratic = static_cast<float>(options.thickness_quadratic);
  const float nx = plane.normal.x(), ny = plane.normal.y(), nz = plane.normal.z();
  const float distance = plane.distance;
  const auto* ray = view.rays.ptr<cv::Vec2f>(y);
  const auto* depth = view.depth.ptr<float>(y);
  std::uint8_t* out = near.data();
  const int columns = view.depth.cols;
  for (int x = 0; x < columns; ++x) {
    const float z = depth[x];
    const float off = (nx * ray[x][0] + ny * ray[x][1] + nz) * z - distance;
    out[x] = std::abs(off) < constant + quadratic * z * z ? 1 : 0;
  }
}

}  // namespace

void PlaneOptions::describe(OptionList& list) {
  list.add("max_planes", max_planes, between(0, 100), "", "found in one frame");
  list.add("min_share", min_share, between(0, 1), "", "of the points; smaller planes are things");
  list.add("min_extent", min_extent, at_least(0), "metres", "of a plane along its longer axis");
  list.add("min_width", min_width, at_least(0), "metres", "of a plane across");
  list.add("thickness_constant", thickness_constant, at_least(0), "metres",
           "half thickness of a plane at no depth");
  list.add("thickness_quadratic", thickness_quadratic, at_least(0), "1/metre",
           "half thickness that depth squared adds");
  list.add("iterations", iterations, between(1, 100000), "", "of RANSAC");
  list.add("min_along", min_along, between(0, 1), "",
           "of a plane's points: a plane that fewer run along cuts through things");
  list.add("removal_margin", removal_margin, at_least(0), "metres",
           "added to the thickness when pixels are removed");
  list.add("slope_error", slope_error, at_least(0), "",
           "rise over run by which a surface on the plane may lean off it");
}

void PlaneOptions::check() const { check_options(*this); }

PlaneOptions larger_than_people(PlaneOptions options) {
  constexpr double extent = 1.0, width = 0.6;  // metres
  options.min_extent = std::max(options.min_extent, extent);
  options.min_width = std::max(options.min_width, width);
  return options;
}

bool is_large_enough(const Plane& plane, const PlaneOptions& options) {
  return static_cast<double>(plane.extent) >= options.min_extent &&
         static_cast<double>(plane.width) >= options.min_width;
}

void InlierCounter::add(const Eigen::Vector3f& point, float tolerance) {
  x_.push_back(point.x());
  y_.push_back(point.y());
  z_.push_back(point.z());
  tolerance_.push_back(tolerance);
}

int InlierCounter::count(const Plane& plane) const {
  const float nx = plane.normal.x(), ny = plane.normal.y(), nz = plane.normal.z();
  int inliers = 0;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const float off = nx * x_[i] + (ny * y_[i] + nz * z_[i]) - plane.distance;
    inliers += std::abs(off) < tolerance_[i] ? 1 : 0;
  }
  return inliers;
}

bool lies_on(const Plane& plane, const Eigen::Vector3f& point, const PlaneOptions& options,
             float margin) {
  return std::abs(plane.normal.dot(point) - plane.distance) <
         half_thickness(point.z(), options) + margin;
}

std::optional<Plane> plane_through(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                                   const Eigen::Vector3f& c) {
  const Eigen::Vector3f normal = (b - a).cross(c - a);
  const float length = normal.norm();
  constexpr float min_area = 5e-4F;  // square metres: thinner triangles have no stable normal
  if (length < min_area) return std::nullopt;
  return Plane{normal / length, normal.dot(a) / length, 0.0F, 0.0F};
}

Plane fit_plane(const std::vector<Eigen::Vector3f>& points) { return least_squares(points); }

std::vector<Plane> fit_planes(const DepthView& view, const cv::Mat& exclude,
                              const PlaneOptions& options, std::uint64_t seed) {
  Samples left = sample_points(view, exclude);
  const auto needed = static_cast<int>(options.min_share * static_cast<double>(left.points.size()));
  std::vector<Plane> planes;
  std::mt19937_64 random(seed);
  constexpr int min_points = 30;
  for (int round = 0; round < options.max_planes; ++round) {
    if (static_cast<int>(left.points.size()) <= std::max(min_points, needed)) break;
    LargestPlane problem(left.points, options, random);
    const auto found = ransac<Plane>(problem, options.iterations, 0);
    if (!found.model || found.score < std::max(min_points, needed)) break;
    const Samples on = points_on(left, *found.model, options, true);
    const Plane best = least_squares(on.points);
    if (is_large_enough(best, options) && !seen_edge_on(best, on.points) &&
        !cuts_through(view, best, on.pixels, options)) {
      planes.push_back(best);
    }
    left = points_on(left, best, options, false);
  }
  return planes;
}

bool runs_along(const DepthView& view, const Plane& plane, int x, int y,
                const PlaneOptions& options) {
  const float z = view.depth.at<float>(y, x);
  if (z <= 0.0F) return false;
  if (!lies_on(plane, view.point(x, y), options, static_cast<float>(options.removal_margin))) {
    return false;
  }
  // A plane seen more flatly than this across `reach` pixels is too far off to be anyone's table.
  constexpr float edge_share = 0.06F;  // of the depth
  constexpr int reach = 3;  // pixels of the view to each side: the slope is taken over 2 * reach
  const auto depth_at = [&](int px, int py) {
    const bool inside = px >= 0 && py >= 0 && px < view.depth.cols && py < view.depth.rows;
    return inside ? view.depth.at<float>(py, px) : 0.0F;
  };
  const auto plane_depth = [&](int px, int py) {
    const auto& ray = view.rays.at<cv::Vec2f>(py, px);
    const float n = plane.normal.dot(Eigen::Vector3f(ray[0], ray[1], 1.0F));
    return std::abs(n) < 1e-4F ? 1e4F : plane.distance / n;
  };
  // Depth of the plane along the rays at both ends of a small cross, against what is there.
  for (const auto& [dx, dy] : std::array<std::pair<int, int>, 2>{{{reach, 0}, {0, reach}}}) {
    const float near_z = depth_at(x - dx, y - dy);
    const float far_z = depth_at(x + dx, y + dy);
    // At an outline one side belongs to something else: position alone decides.
    if (near_z <= 0.0F || far_z <= 0.0F) continue;
    if (std::max(std::abs(near_z - z), std::abs(far_z - z)) > edge_share * z) continue;
    const float rise =
        (far_z - near_z) - (plane_depth(x + dx, y + dy) - plane_depth(x - dx, y - dy));
    const auto& r0 = view.rays.at<cv::Vec2f>(y - dy, x - dx);
    const auto& r1 = view.rays.at<cv::Vec2f>(y + dy, x + dx);
    const float run = z * (std::abs(r1[0] - r0[0]) + std::abs(r1[1] - r0[1]));
    // Two readings' noise on top of the slope.
    const float allowed =
        static_cast<float>(options.slope_error) * run + 0.5F * half_thickness(z, options);
    if (std::abs(rise) >= allowed) return false;
  }
  return true;
}

bool runs_along_any(const DepthView& view, const std::vector<Plane>& planes, const cv::Point& pixel,
                    const PlaneOptions& options) {
  const int x = std::clamp(pixel.x / DepthView::step, 0, view.depth.cols - 1);
  const int y = std::clamp(pixel.y / DepthView::step, 0, view.depth.rows - 1);
  return std::any_of(planes.begin(), planes.end(),
                     [&](const Plane& plane) { return runs_along(view, plane, x, y, options); });
}

cv::Mat plane_pixels(const DepthView& view, const std::vector<Plane>& planes, const cv::Rect& area,
                     const PlaneOptions& options) {
  cv::Mat out = cv::Mat::zeros(view.depth.size(), CV_8UC1);
  const cv::Rect inside = area & cv::Rect(0, 0, out.cols, out.rows);
  cv::parallel_for_({inside.y, inside.y + inside.height}, [&](const cv::Range& rows) {
    std::vector<std::uint8_t> near(static_cast<std::size_t>(view.depth.cols));
    for (const Plane& plane : planes) {
      for (int y = rows.start; y < rows.end; ++y) {
        mark_near(view, plane, y, options, near);
        auto* on = out.ptr<std::uint8_t>(y);
        for (int x = inside.x; x < inside.x + inside.width; ++x) {
          if (near[static_cast<std::size_t>(x)] == 0 || on[x] != 0) continue;
          if (runs_along(view, plane, x, y, options)) on[x] = 255;
        }
      }
    }
  });
  return out;
}

}  // namespace dkp_slam
