#include "dkp_slam/geometry/camera.h"

#include <cmath>

namespace dkp_slam {
namespace {

/// Distorted normalised coordinates of undistorted ones (x, y), and what OpenCV calls the
/// tangential part apart, so that the inverse can iterate.
struct LensTerms {
  double radial, dx, dy;
};

LensTerms lens_terms(const Distortion& d, double x, double y) {
  const double r2 = x * x + y * y;
  return {1.0 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3)),
          2.0 * d.p1 * x * y + d.p2 * (r2 + 2.0 * x * x),
          d.p1 * (r2 + 2.0 * y * y) + 2.0 * d.p2 * x * y};
}

}  // namespace

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& pixel) const {
  if (distortion.none()) return pixel;
  const double x = (pixel.x() - cx) / fx;
  const double y = (pixel.y() - cy) / fy;
  const LensTerms t = lens_terms(distortion, x, y);
  return {fx * (x * t.radial + t.dx) + cx, fy * (y * t.radial + t.dy) + cy};
}

std::vector<cv::Point2f> Camera::undistort(const std::vector<cv::Point2f>& raw) const {
  if (distortion.none()) return raw;
  // The iteration contracts by 0.3 a step and better on the lenses at hand; most pixels need five.
  constexpr int iterations = 20;
  const double enough = 1e-5 / fx;  // normalised: a hundred-thousandth of a pixel
  std::vector<cv::Point2f> out;
  out.reserve(raw.size());
  for (const cv::Point2f& p : raw) {
    const double xd = (p.x - cx) / fx;
    const double yd = (p.y - cy) / fy;
    double x = xd, y = yd;
    for (int i = 0; i < iterations; ++i) {
      const LensTerms t = lens_terms(distortion, x, y);
      const double next_x = (xd - t.dx) / t.radial, next_y = (yd - t.dy) / t.radial;
      const double change = std::abs(next_x - x) + std::abs(next_y - y);
      x = next_x;
      y = next_y;
      if (change < enough) break;
    }
    out.emplace_back(static_cast<float>(fx * x + cx), static_cast<float>(fy * y + cy));
  }
  return out;
}

std::optional<std::string> Camera::check() const {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0.0; };
  if (width <= 0 || height <= 0) return "width and height must be above 0";
  if (!positive(fx)) return "fx must be a positive number of pixels";
  if (!positive(fy)) return "fy must be a positive number of pixels";
  if (!std::isfinite(cx) || cx < 0.0 || cx > width) return "cx must lie inside the image";
  if (!std::isfinite(cy) || cy < 0.0 || cy > height) return "cy must lie inside the image";
  for (double v : {distortion.k1, distortion.k2, distortion.p1, distortion.p2, distortion.k3}) {
    if (!std::isfinite(v)) return "distortion must hold finite numbers";
  }
  if (!positive(depth_scale)) return "depth_scale must be above 0";
  if (!positive(baseline)) return "baseline must be above 0";
  if (!positive(frame_rate)) return "frame_rate must be above 0";
  if (!std::isfinite(readout) || readout < 0.0 || readout > 1.0 / frame_rate) {
    return "readout must lie between 0 and the time of a frame, 1 / frame_rate";
  }
  const double of_depth = readout_of_depth();
  if (!std::isfinite(of_depth) || of_depth < 0.0 || of_depth > 1.0 / frame_rate) {
    return "depth_readout must lie between 0 and the time of a frame, 1 / frame_rate";
  }
  if (!positive(min_depth) || !positive(max_depth) || min_depth >= max_depth) {
    return "min_depth and max_depth must be above 0, in this order";
  }
  if (!positive(depth_noise.constant) || !std::isfinite(depth_noise.quadratic) ||
      depth_noise.quadratic < 0.0) {
    return "depth_noise must be a positive constant and a quadratic term of at least 0";
  }
  return std::nullopt;
}

}  // namespace dkp_slam
