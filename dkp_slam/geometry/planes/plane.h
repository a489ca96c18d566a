#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/geometry/planes/depth_view.h"

namespace dkp_slam {

class OptionList;

/// Plane normal . X = distance in the camera frame; unit normal, metres.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float distance = 0.0F;
  float extent = 0.0F;  ///< metres of it that were seen along its longer axis; 0: unknown
  float width = 0.0F;   ///< the same across
};

struct PlaneOptions {
  int max_planes = 3;       ///< table, floor and a wall are what people stand in front of
  double min_share = 0.12;  ///< of the sampled points: smaller planes are things, not the room
  /// Length of what is seen of a plane, metres: a monitor is shorter, and its plane goes on in
  /// thought through whoever stands beside it.
  double min_extent = 0.7;
  double min_width = 0.45;  ///< the same across: somebody's back is narrower
  /// Half thickness, metres, at depth z: constant + quadratic * z^2. A Kinect's noise at the
  /// outline of things and its slow bending of planes, about 3 sigma of Nguyen's formula plus 1 cm.
  double thickness_constant = 0.015;
  double thickness_quadratic = 0.006;
  int iterations = 80;  ///< RANSAC: with 12% of inliers in the worst case, guided by locality
  /// Share of a plane's points whose surface runs along it: one through a floor, a chair and an arm
  /// has points of all, and hardly any surface.
  double min_along = 0.4;
  /// Added to it when pixels are removed, metres: what lies flat on a table (books, a keyboard)
  /// goes with it.
  double removal_margin = 0.02;
  double slope_error = 0.45;  ///< rise over run by which a surface on the plane may lean off it

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// The same for planes that are nobody's: a table, a floor or a wall stands still, whatever else is
/// known of the view. A back is narrower; two side by side seldom make one plane of this size.
PlaneOptions larger_than_people(PlaneOptions options);

/// By `min_extent` and `min_width`.
bool is_large_enough(const Plane& plane, const PlaneOptions& options);

/// Points, each with the distance by which it may lie off a plane: RANSAC asks again and again how
/// many a plane holds. Kept by coordinate, so that the compiler counts several at a time.
class InlierCounter {
 public:
  void add(const Eigen::Vector3f& point, float tolerance);
  /// Points nearer to the plane than their tolerance.
  int count(const Plane& plane) const;

 private:
  std::vector<float> x_, y_, z_, tolerance_;
};

/// Plane through three points; nothing when they lie too close to a line.
std::optional<Plane> plane_through(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                                   const Eigen::Vector3f& c);

/// Plane of least squares through at least three points.
Plane fit_plane(const std::vector<Eigen::Vector3f>& points);

/// Largest planes of the view by RANSAC and least squares, over pixels where `exclude` (CV_8UC1,
/// view size, may be empty) is 0. The largest comes first.
std::vector<Plane> fit_planes(const DepthView& view, const cv::Mat& exclude,
                              const PlaneOptions& options, std::uint64_t seed);

/// Within the plane's half thickness and `margin` metres.
bool lies_on(const Plane& plane, const Eigen::Vector3f& point, const PlaneOptions& options,
             float margin = 0.0F);

/// Whether the view's surface lies on the plane at a pixel of the view and runs along it.
bool runs_along(const DepthView& view, const Plane& plane, int x, int y,
                const PlaneOptions& options);

/// The same for any of the planes, at a pixel of the image (the nearest inside it).
bool runs_along_any(const DepthView& view, const std::vector<Plane>& planes, const cv::Point& pixel,
                    const PlaneOptions& options);

/// 255 where the view's surface lies on one of the planes and runs along it: a person who stands
/// in the floor's or table's extension crosses it, but does not run along it. CV_8UC1, computed
/// within `area` only (0 elsewhere).
cv::Mat plane_pixels(const DepthView& view, const std::vector<Plane>& planes, const cv::Rect& area,
                     const PlaneOptions& options);

}  // namespace dkp_slam
