#include "dkp_slam/tracking/relocalizer.h"

#include <spdlog/spdlog.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "dkp_slam/tracking/matcher.h"
#include "dkp_slam/tracking/pose_refinement.h"

namespace dkp_slam {
namespace {

constexpr std::size_t least_matches = 15;  // worth a RANSAC
constexpr int least_inliers = 30;          // after the guided search: a pose to trust
constexpr int best_candidates = 5;         // keyframes that get a RANSAC

/// A first pose from matches with many outliers. OpenCV seeds this RANSAC itself, the same each
/// time.
bool solve_pnp(const Map& map, const std::vector<FrameMatch>& matches, Frame& frame) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const FrameMatch& m : matches) {
    points.emplace_back(m.position.x(), m.position.y(), m.position.z());
    pixels.push_back(frame.features.pixel[static_cast<std::size_t>(m.feature)]);
  }
  cv::Mat rotation_vector, translation, inliers;
  constexpr double reprojection_bound = 4.0;  // pixels
  if (!cv::solvePnPRansac(points, pixels, map.camera().matrix(), cv::noArray(), rotation_vector,
                          translation, false, 200, reprojection_bound, 0.99, inliers,
                          cv::SOLVEPNP_EPNP)) {
    return false;
  }
  if (inliers.total() < 10) return false;
  cv::Mat rotation;
  cv::Rodrigues(rotation_vector, rotation);
  Eigen::Matrix3d r;
  Eigen::Vector3d t;
  cv::cv2eigen(rotation, r);
  cv::cv2eigen(translation, t);
  frame.camera_from_world = Se3(Eigen::Quaterniond(r).normalized(), t);
  return true;
}

std::vector<int> landmarks_around(const Map& map, int keyframe) {
  std::vector<int> ids = map.best_covisible(keyframe, 10);
  ids.push_back(keyframe);
  return map.landmarks_of(ids);
}

bool try_keyframe(const Map& map, const MeasurementModel& model, int keyframe,
                  std::vector<FrameMatch> matches, Frame& frame) {
  if (!solve_pnp(map, matches, frame)) return false;
  if (refine_pose(map, model, frame, matches) < 10) return false;
  std::fill(frame.landmark.begin(), frame.landmark.end(), -1);
  for (const FrameMatch& m : matches)
    frame.landmark[static_cast<std::size_t>(m.feature)] = m.landmark;
  std::vector<int> others;
  for (const int l : landmarks_around(map, keyframe)) {
    if (std::find(frame.landmark.begin(), frame.landmark.end(), l) == frame.landmark.end())
      others.push_back(l);
  }
  for (const FrameMatch& m :
       match_visible(map, frame, landmarks_in_view(map, frame, others), 3.0F)) {
    if (frame.is_static[static_cast<std::size_t>(m.feature)]) matches.push_back(m);
  }
  const int inliers = refine_pose(map, model, frame, matches);
  if (inliers < least_inliers) return false;
  std::fill(frame.landmark.begin(), frame.landmark.end(), -1);
  for (const FrameMatch& m : matches)
    frame.landmark[static_cast<std::size_t>(m.feature)] = m.landmark;
  frame.reference_keyframe = keyframe;
  spdlog::info("frame {}: relocalised in keyframe {} with {} landmarks", frame.index, keyframe,
               inliers);
  return true;
}

}  // namespace

bool relocalize(const Map& map, const MeasurementModel& model, Frame& frame) {
  std::vector<std::pair<int, std::vector<FrameMatch>>> candidates;
  for (int k = map.keyframe_ids() - 1; k >= 0; --k) {
    if (map.keyframe(k).removed) continue;
    std::vector<FrameMatch> matches = match_keyframe(map, map.keyframe(k), frame);
    if (matches.size() >= least_matches) candidates.emplace_back(k, std::move(matches));
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
  if (candidates.size() > best_candidates) candidates.resize(best_candidates);
  for (auto& [keyframe, matches] : candidates) {
    if (try_keyframe(map, model, keyframe, std::move(matches), frame)) return true;
  }
  std::fill(frame.landmark.begin(), frame.landmark.end(), -1);
  return false;
}

}  // namespace dkp_slam
