#include "dkp_slam/sensor/depth_registration.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace dkp_slam {
namespace {

/// Pixels whose centres lie between two edges, the lower one's side included: squares that meet
/// leave none out and have none in common.
cv::Range centres_between(double one, double other, int size) {
  const auto first_after = [size](double edge) {
    return static_cast<int>(std::ceil(std::clamp(edge, 0.0, static_cast<double>(size))));
  };
  return {first_after(std::min(one, other)), first_after(std::max(one, other))};
}

}  // namespace

struct DepthRegistration::Spot {
  double u = 0.0, v = 0.0;  // raw pixel of the colour image
  double depth = 0.0;       // metres along the colour camera's z
};

DepthRegistration::DepthRegistration(const Camera& depth, const Camera& colour,
                                     const Se3& colour_from_depth)
    : depth_(depth), colour_(colour), colour_from_depth_(colour_from_depth) {
  std::vector<cv::Point2f> raw;
  for (int y = 0; y <= depth.height; ++y) {
    for (int x = 0; x <= depth.width; ++x) {
      raw.emplace_back(static_cast<float>(x) - 0.5F, static_cast<float>(y) - 0.5F);
    }
  }
  const std::vector<cv::Point2f> straight = depth.distortion.none() ? raw : depth.undistort(raw);
  for (const cv::Point2f& p : straight) corners_.push_back(depth.unproject({p.x, p.y}, 1.0));
}

DepthRegistration::Spot DepthRegistration::project(int corner, float depth) const {
  const Eigen::Vector3d point =
      colour_from_depth_ * (corners_[static_cast<std::size_t>(corner)] * depth);
  if (!(point.z() > 0.0)) return {};
  Eigen::Vector2d pixel = colour_.project(point);
  if (!colour_.distortion.none()) pixel = colour_.distort(pixel);
  return {pixel.x(), pixel.y(), point.z()};
}

cv::Mat DepthRegistration::registered(const cv::Mat& depth) const {
  CV_Assert(depth.type() == CV_32FC1 && depth.cols == depth_.width && depth.rows == depth_.height);
  cv::Mat result(colour_.height, colour_.width, CV_32FC1, cv::Scalar(0));
  const int stride = depth.cols + 1;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth.at<float>(y, x);
      if (!(z > 0.0F)) continue;
      const Spot from = project(y * stride + x, z), to = project((y + 1) * stride + x + 1, z);
      if (!(from.depth > 0.0 && to.depth > 0.0)) continue;
      const auto seen = static_cast<float>(0.5 * (from.depth + to.depth));
      const cv::Range rows = centres_between(from.v, to.v, result.rows);
      const cv::Range columns = centres_between(from.u, to.u, result.cols);
      for (int v = rows.start; v < rows.end; ++v) {
        for (int u = columns.start; u < columns.end; ++u) {
          float& there = result.at<float>(v, u);
          if (there == 0.0F || seen < there) there = seen;
        }
      }
    }
  }
  return result;
}

}  // namespace dkp_slam
