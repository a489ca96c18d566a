#include "dkp_slam/detection/motion/motion_evidence.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace dkp_slam {
namespace {

/// Mean absolute difference over 3 x 3 cells between `current` and `earlier` looked up at `at`.
cv::Mat image_difference(const cv::Mat& current, const cv::Mat& earlier, const cv::Mat& at) {
  cv::Mat warped, difference;
  cv::remap(earlier, warped, at, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::absdiff(current, warped, difference);
  cv::blur(difference, difference, {3, 3});
  return difference;
}

/// Root mean square gradient over 5 x 5 cells.
cv::Mat texture_of(const cv::Mat& grey) {
  cv::Mat dx, dy, energy;
  cv::Sobel(grey, dx, CV_32F, 1, 0, 1, 0.5);
  cv::Sobel(grey, dy, CV_32F, 0, 1, 1, 0.5);
  energy = dx.mul(dx) + dy.mul(dy);
  cv::blur(energy, energy, {5, 5});
  cv::sqrt(energy, energy);
  return energy;
}

struct DepthRange {
  float nearest = 0.0F;   ///< metres, 0 when all cells are unknown
  bool complete = false;  ///< every cell is known
};

/// Depths of the 3 x 3 cells around (u, v).
DepthRange range_around(const cv::Mat& depth, int u, int v) {
  DepthRange range;
  if (u < 1 || v < 1 || u + 1 >= depth.cols || v + 1 >= depth.rows) return range;
  range.complete = true;
  for (int y = v - 1; y <= v + 1; ++y) {
    const float* row = depth.ptr<float>(y);
    for (int x = u - 1; x <= u + 1; ++x) {
      if (row[x] <= 0.0F) {
        range.complete = false;
      } else if (range.nearest == 0.0F || row[x] < range.nearest) {
        range.nearest = row[x];
      }
    }
  }
  return range;
}

}  // namespace

MotionEvidenceFinder::MotionEvidenceFinder(const CoarseGrid& grid,
                                           const MotionEvidenceOptions& options)
    : grid_(grid), options_(options), flow_(cv::DISOpticalFlow::create()) {
  // The images are small already: down to the last scale, without the slow variational step.
  flow_->setFinestScale(0);
  flow_->setPatchSize(8);
  flow_->setPatchStride(4);
  flow_->setGradientDescentIterations(16);
  flow_->setVariationalRefinementIterations(0);
}

MotionEvidence MotionEvidenceFinder::find(const CoarseView& current, const CoarseView& earlier,
                                          const Se3& earlier_from_current) {
  const cv::Size size = grid_.size();
  MotionEvidence evidence;
  flow_->calc(current.grey, earlier.grey, evidence.flow);
  evidence.vote = cv::Mat::zeros(size, CV_8SC1);
  evidence.came = cv::Mat::zeros(size, CV_8UC1);

  const Eigen::Matrix3f rotation = earlier_from_current.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = earlier_from_current.translation.cast<float>();
  cv::Mat by_flow(size, CV_32FC2), by_camera(size, CV_32FC2);
  cv::Mat residual(size, CV_32FC1, cv::Scalar(-1));  // unknown
  const cv::Mat texture = texture_of(current.grey);
  std::vector<float> textured;
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const cv::Vec2f flow = evidence.flow.at<cv::Vec2f>(v, u);
      const cv::Vec2f cell(static_cast<float>(u), static_cast<float>(v));
      by_flow.at<cv::Vec2f>(v, u) = by_camera.at<cv::Vec2f>(v, u) = cell + flow;
      const float z = current.depth.at<float>(v, u);
      if (z <= 0.0F) continue;
      const Eigen::Vector3f point = rotation * (z * grid_.ray(v * size.width + u)) + translation;
      if (point.z() < 0.1F) continue;
      const cv::Point2f at = grid_.project(point);
      by_camera.at<cv::Vec2f>(v, u) = {at.x, at.y};
      const int x = cvRound(at.x), y = cvRound(at.y);
      if (x < 0 || y < 0 || x >= size.width || y >= size.height) continue;
      const DepthRange seen = range_around(earlier.depth, x, y);
      const float tolerance = options_.depth_tolerance * point.z();
      if (seen.complete && seen.nearest > point.z() + tolerance)
        evidence.came.at<uchar>(v, u) = 255;
      // Something was in front of it then: flow has no counterpart to find.
      if (seen.nearest > 0.0F && seen.nearest < point.z() - tolerance) continue;
      const float miss = std::hypot(u + flow[0] - at.x, v + flow[1] - at.y);
      residual.at<float>(v, u) = miss;
      if (texture.at<float>(v, u) > options_.min_texture) textured.push_back(miss);
    }
  }
  float threshold = options_.min_residual;
  if (!textured.empty()) {
    const auto middle = textured.begin() + static_cast<std::ptrdiff_t>(textured.size() / 2);
    std::nth_element(textured.begin(), middle, textured.end());
    // With half of the image moving the median says nothing: bounded.
    threshold = std::clamp(options_.residual_medians * *middle, threshold, 4.0F * threshold);
  }
  // Patches of the flow that reach over the image's border match nothing.
  constexpr int margin = 4;
  const cv::Rect inside(margin, margin, size.width - 2 * margin, size.height - 2 * margin);
  const cv::Mat flow_difference = image_difference(current.grey, earlier.grey, by_flow);
  const cv::Mat camera_difference = image_difference(current.grey, earlier.grey, by_camera);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const float miss = residual.at<float>(v, u);
      if (miss < 0.0F || texture.at<float>(v, u) < options_.min_texture) continue;
      const float gain = static_cast<float>(camera_difference.at<uchar>(v, u)) -
                         static_cast<float>(flow_difference.at<uchar>(v, u));
      if (miss > threshold && gain > options_.min_contrast && inside.contains(cv::Point(u, v)) &&
          inside.contains(cv::Point2f(by_flow.at<cv::Point2f>(v, u)))) {
        evidence.vote.at<schar>(v, u) = 1;
      } else if (miss < 0.5F * threshold) {
        evidence.vote.at<schar>(v, u) = -1;
      }
    }
  }
  return evidence;
}

}  // namespace dkp_slam
