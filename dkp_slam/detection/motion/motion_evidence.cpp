#include "dkp_slam/detection/motion/motion_evidence.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace dkp_slam {
namespace {

// Patches of the flow that reach over the image's border match nothing.
constexpr int flow_margin = 4;   // cells
constexpr int least_asked = 50;  // cells, of which nobody would be made

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
    : grid_(grid),
      options_(options),
      inside_(flow_margin, flow_margin, grid.size().width - 2 * flow_margin,
              grid.size().height - 2 * flow_margin),
      flow_(cv::DISOpticalFlow::create()) {
  // The images are small already: down to the last scale, without the slow variational step.
  flow_->setFinestScale(0);
  flow_->setPatchSize(8);
  flow_->setPatchStride(4);
  flow_->setGradientDescentIterations(16);
  flow_->setVariationalRefinementIterations(0);
}

MotionEvidenceFinder::Followed MotionEvidenceFinder::follow(const CoarseView& current,
                                                            const CoarseView& earlier,
                                                            const Se3& earlier_from_current,
                                                            const cv::Rect& part) const {
  Followed followed{part,
                    {},
                    cv::Mat(part.size(), CV_32FC2),
                    cv::Mat(part.size(), CV_32FC2),
                    cv::Mat(part.size(), CV_32FC1, cv::Scalar(-1)),
                    cv::Mat::zeros(part.size(), CV_8UC1),
                    cv::Mat::zeros(part.size(), CV_8UC1)};
  flow_->calc(current.grey(part).clone(), earlier.grey(part).clone(), followed.flow);
  const cv::Size size = grid_.size();
  const Eigen::Matrix3f rotation = earlier_from_current.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = earlier_from_current.translation.cast<float>();
  for (int row = 0; row < part.height; ++row) {
    for (int column = 0; column < part.width; ++column) {
      const int u = part.x + column, v = part.y + row;
      const cv::Vec2f flow = followed.flow.at<cv::Vec2f>(row, column);
      const cv::Vec2f cell(static_cast<float>(u), static_cast<float>(v));
      followed.by_flow.at<cv::Vec2f>(row, column) = cell + flow;
      followed.by_camera.at<cv::Vec2f>(row, column) = cell + flow;
      const float z = current.depth.at<float>(v, u);
      if (z <= 0.0F) continue;
      const Eigen::Vector3f middle = rotation * grid_.point({u, v}, z, current.rows) + translation;
      if (middle.z() < 0.1F) continue;
      const Eigen::Vector3f point = grid_.as_seen(middle, earlier.rows);
      if (point.z() < 0.1F) continue;
      const cv::Point2f at = grid_.project(point);
      followed.by_camera.at<cv::Vec2f>(row, column) = {at.x, at.y};
      const int x = cvRound(at.x), y = cvRound(at.y);
      if (!inside_.contains(cv::Point(x, y))) followed.unseen.at<uchar>(row, column) = 255;
      if (x < 0 || y < 0 || x >= size.width || y >= size.height) continue;
      const DepthRange seen = range_around(earlier.depth, x, y);
      const float tolerance = options_.depth_tolerance * point.z();
      if (seen.complete && seen.nearest > point.z() + tolerance)
        followed.came.at<uchar>(row, column) = 255;
      // Something was in front of it then: flow has no counterpart to find.
      if (seen.nearest > 0.0F && seen.nearest < point.z() - tolerance) continue;
      followed.miss.at<float>(row, column) =
          std::hypot(cell[0] + flow[0] - at.x, cell[1] + flow[1] - at.y);
    }
  }
  return followed;
}

float MotionEvidenceFinder::least_miss(const cv::Mat& miss, const cv::Mat& texture) const {
  std::vector<float> textured;
  for (int v = 0; v < miss.rows; ++v) {
    for (int u = 0; u < miss.cols; ++u) {
      const float cells = miss.at<float>(v, u);
      if (cells >= 0.0F && texture.at<float>(v, u) > options_.min_texture)
        textured.push_back(cells);
    }
  }
  const float least = options_.min_residual;
  if (textured.empty()) return least;
  const auto middle = textured.begin() + static_cast<std::ptrdiff_t>(textured.size() / 2);
  std::nth_element(textured.begin(), middle, textured.end());
  // With half of the image moving the median says nothing: bounded.
  return std::clamp(options_.residual_medians * *middle, least, 4.0F * least);
}

cv::Mat MotionEvidenceFinder::votes(const CoarseView& current, const CoarseView& earlier,
                                    const Followed& followed, const cv::Mat& texture,
                                    float threshold) const {
  const cv::Mat seen = current.grey(followed.part);
  const cv::Mat by_flow = image_difference(seen, earlier.grey, followed.by_flow);
  const cv::Mat by_camera = image_difference(seen, earlier.grey, followed.by_camera);
  cv::Mat votes = cv::Mat::zeros(followed.part.size(), CV_8SC1);
  for (int v = 0; v < votes.rows; ++v) {
    for (int u = 0; u < votes.cols; ++u) {
      const float miss = followed.miss.at<float>(v, u);
      if (miss < 0.0F || texture.at<float>(v, u) < options_.min_texture) continue;
      const float gain = static_cast<float>(by_camera.at<uchar>(v, u)) -
                         static_cast<float>(by_flow.at<uchar>(v, u));
      if (miss > threshold && gain > options_.min_contrast &&
          inside_.contains(cv::Point(u, v) + followed.part.tl()) &&
          inside_.contains(cv::Point2f(followed.by_flow.at<cv::Point2f>(v, u)))) {
        votes.at<schar>(v, u) = 1;
      } else if (miss < 0.5F * threshold) {
        votes.at<schar>(v, u) = -1;
      }
    }
  }
  return votes;
}

MotionEvidence MotionEvidenceFinder::find(const CoarseView& current, const CoarseView& earlier,
                                          const Se3& earlier_from_current) const {
  const Followed followed =
      follow(current, earlier, earlier_from_current, cv::Rect({}, grid_.size()));
  MotionEvidence evidence;
  evidence.texture = texture_of(current.grey);
  evidence.threshold = least_miss(followed.miss, evidence.texture);
  evidence.vote = votes(current, earlier, followed, evidence.texture, evidence.threshold);
  evidence.flow = followed.flow;
  evidence.came = followed.came;
  evidence.unseen = followed.unseen;
  return evidence;
}

void MotionEvidenceFinder::add_newer(const CoarseView& current, const CoarseView& newer,
                                     const Se3& newer_from_current,
                                     MotionEvidence& evidence) const {
  const cv::Mat asked =
      evidence.unseen & (evidence.vote == 0) & (evidence.texture > options_.min_texture);
  const cv::Mat within = asked(inside_);
  if (cv::countNonZero(within) < least_asked) return;
  constexpr int around = 16;  // cells, from which flow may come
  const cv::Rect least = cv::boundingRect(within) + inside_.tl();
  const cv::Rect part =
      cv::Rect(least.tl() - cv::Point(around, around), least.br() + cv::Point(around, around)) &
      cv::Rect({}, asked.size());
  const Followed followed = follow(current, newer, newer_from_current, part);
  const cv::Mat found = votes(current, newer, followed, evidence.texture(part), evidence.threshold);
  cv::Mat into = evidence.vote(part);
  into.setTo(1, asked(part) & (found > 0));
}

}  // namespace dkp_slam
