#include "dkp_slam/detection/motion/background_model.h"

#include <algorithm>
#include <cmath>

namespace dkp_slam {

BackgroundModel::BackgroundModel(const CoarseGrid& grid, const Camera& camera,
                                 const BackgroundOptions& options)
    : grid_(grid), noise_(camera.depth_noise), options_(options) {
  clear();
}

void BackgroundModel::clear() {
  cells_.assign(static_cast<std::size_t>(grid_.size().area()), Cell{});
}

float BackgroundModel::tolerance_at(float depth) const {
  return static_cast<float>(options_.tolerance + options_.tolerance_sigmas * noise_.sigma(depth));
}

void BackgroundModel::move(const Se3& current_from_previous, const RowMotion& rows) {
  const Eigen::Matrix3f rotation = current_from_previous.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = current_from_previous.translation.cast<float>();
  moved_.assign(cells_.size(), Cell{});
  const cv::Size size = grid_.size();
  constexpr float nearest = 0.1F;
  for (const Cell& cell : cells_) {
    if (cell.age == 0) continue;
    const Eigen::Vector3f point = rotation * cell.point + translation;
    if (point.z() < nearest) continue;
    const Eigen::Vector3f seen = grid_.as_seen(point, rows);
    if (seen.z() < nearest) continue;
    const cv::Point2f at = grid_.project(seen);
    const int u = cvRound(at.x), v = cvRound(at.y);
    if (u < 0 || v < 0 || u >= size.width || v >= size.height) continue;
    Cell& target = moved_[static_cast<std::size_t>(v * size.width + u)];
    if (target.age == 0 || seen.z() < target.depth) target = {point, cell.age, seen.z()};
  }
  cells_.swap(moved_);
}

cv::Mat BackgroundModel::compare(const cv::Mat& depth) const {
  const cv::Size size = grid_.size();
  cv::Mat evidence(size, CV_8UC1, cv::Scalar(static_cast<int>(DepthEvidence::unknown)));
  for (int v = 0; v < size.height; ++v) {
    const float* z = depth.ptr<float>(v);
    uchar* out = evidence.ptr<uchar>(v);
    const int top = std::max(0, v - 1), bottom = std::min(size.height - 1, v + 1);
    for (int u = 0; u < size.width; ++u) {
      if (z[u] <= 0.0F) continue;
      // The nearest and the farthest surface around: an edge may lie a cell off.
      float nearest = 0.0F, farthest = 0.0F;
      const int left = std::max(0, u - 1), right = std::min(size.width - 1, u + 1);
      for (int y = top; y <= bottom; ++y) {
        for (int x = left; x <= right; ++x) {
          const Cell& cell = cells_[static_cast<std::size_t>(y * size.width + x)];
          if (cell.age == 0) continue;
          const float model = cell.depth;
          if (farthest == 0.0F || model < nearest) nearest = model;
          farthest = std::max(farthest, model);
        }
      }
      if (farthest == 0.0F) continue;
      const float tolerance = tolerance_at(z[u]);
      const DepthEvidence found = z[u] < nearest - tolerance    ? DepthEvidence::nearer
                                  : z[u] > farthest + tolerance ? DepthEvidence::farther
                                                                : DepthEvidence::consistent;
      out[u] = static_cast<uchar>(found);
    }
  }
  return evidence;
}

void BackgroundModel::update(const CoarseView& view, const cv::Mat& evidence, const cv::Mat& moving,
                             const cv::Mat& absorb) {
  const cv::Size size = grid_.size();
  for (int v = 0; v < size.height; ++v) {
    const float* z = view.depth.ptr<float>(v);
    for (int u = 0; u < size.width; ++u) {
      if (z[u] <= 0.0F) continue;
      const int index = v * size.width + u;
      Cell& cell = cells_[static_cast<std::size_t>(index)];
      const Eigen::Vector3f point = grid_.point({u, v}, z[u], view.rows);
      const auto found = static_cast<DepthEvidence>(evidence.at<uchar>(v, u));
      if (absorb.at<uchar>(v, u) || found == DepthEvidence::farther) {
        cell = {point, 1, z[u]};
      } else if (moving.at<uchar>(v, u) || found == DepthEvidence::nearer) {
        continue;
      } else if (cell.age == 0) {
        cell = {point, 1, z[u]};
      } else if (std::abs(cell.depth - z[u]) < tolerance_at(z[u])) {
        cell.point += options_.blend * (point - cell.point);
        cell.age = std::min(cell.age + 1, options_.max_age);
      } else {
        cell.point = point;  // the edge of an object, a cell off
      }
    }
  }
}

}  // namespace dkp_slam
