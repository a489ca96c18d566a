#include "dkp_slam/detection/motion/ego_motion.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "dkp_slam/geometry/sensor_scale.h"

namespace dkp_slam {
namespace {

const cv::Size window(11, 11);
constexpr int pyramid_levels = 3;

/// Depth around a full-size pixel, or 0 where it is unknown or jumps: a corner on an object's edge
/// may belong to either side.
float smooth_depth(const cv::Mat& depth, const cv::Point2f& pixel, int reach) {
  constexpr float jump = 0.04F;
  const int u = cvRound(pixel.x), v = cvRound(pixel.y);
  if (u < reach || v < reach || u + reach >= depth.cols || v + reach >= depth.rows) return 0.0F;
  const float z = depth.at<float>(v, u);
  if (!(z > 0.0F)) return 0.0F;
  for (const auto& [dx, dy] : {std::pair{-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}}) {
    const float other = depth.at<float>(v + dy, u + dx);
    if (other > 0.0F && std::abs(other - z) > jump * z) return 0.0F;
  }
  return z;
}

EgoMotionOptions scaled(EgoMotionOptions options, const SensorScale& scale) {
  options.inlier_pixels *= scale.pixels;
  options.usual_shift = scale.per_frame(options.usual_shift);
  options.usual_turn = scale.per_frame(options.usual_turn);
  return options;
}

}  // namespace

EgoMotionEstimator::EgoMotionEstimator(const Camera& camera, const EgoMotionOptions& options)
    : camera_(camera),
      options_(scaled(options, SensorScale::of(camera))),
      shrink_(std::max(1, cvRound(2.0 * SensorScale::of(camera).pixels))),
      depth_reach_(std::max(1, cvRound(3.0 * SensorScale::of(camera).pixels))) {}

EgoMotion EgoMotionEstimator::update(const cv::Mat& grey, const cv::Mat& depth,
                                     const cv::Mat& trust) {
  cv::Mat small;
  cv::resize(grey, small, grey.size() / shrink_, 0, 0, cv::INTER_AREA);
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(small, pyramid, window, pyramid_levels);
  EgoMotion motion;
  if (!previous_pyramid_.empty()) {
    const std::vector<Match> matches = track(pyramid, trust);
    motion = solve(matches);
    last_motion_ = motion.valid ? motion.current_from_previous : Se3();
  }
  previous_pyramid_ = std::move(pyramid);
  previous_small_ = small;
  previous_depth_ = depth;
  return motion;
}

std::vector<cv::Point2f> EgoMotionEstimator::corners() const {
  cv::Mat response;
  cv::cornerMinEigenVal(previous_small_, response, 3);
  double best = 0.0;
  cv::minMaxLoc(response, nullptr, &best);
  const double least = std::max(1e-6, options_.min_quality * best);
  std::vector<cv::Point2f> found;
  const cv::Rect image({}, previous_small_.size());
  for (int y = 0; y < image.height; y += options_.block) {
    for (int x = 0; x < image.width; x += options_.block) {
      const cv::Rect block = cv::Rect(x, y, options_.block, options_.block) & image;
      double strongest = 0.0;
      cv::Point at;
      cv::minMaxLoc(response(block), nullptr, &strongest, nullptr, &at);
      if (strongest >= least) found.emplace_back(cv::Point2f(at + block.tl()));
    }
  }
  return found;
}

std::vector<EgoMotionEstimator::Match> EgoMotionEstimator::track(
    const std::vector<cv::Mat>& pyramid, const cv::Mat& trust) const {
  const std::vector<cv::Point2f> from = corners();
  std::vector<cv::Point2f> to;
  if (from.empty()) return {};
  std::vector<uchar> found;
  cv::calcOpticalFlowPyrLK(previous_pyramid_, pyramid, from, to, found, cv::noArray(), window,
                           pyramid_levels);
  // Pixels of the small image sit between those of the full one.
  const auto step = static_cast<float>(shrink_);
  const auto to_full = [step](const cv::Point2f& p) {
    const float centre = 0.5F * (step - 1.0F);
    return cv::Point2f(step * p.x + centre, step * p.y + centre);
  };
  std::vector<cv::Point2f> previous_pixels, current_pixels;
  std::vector<float> depths, weights;
  const float to_trust = static_cast<float>(trust.cols) / static_cast<float>(previous_depth_.cols);
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!found[i]) continue;
    const cv::Point2f p = to_full(from[i]), q = to_full(to[i]);
    const float weight =
        trust.at<float>(std::min(static_cast<int>(p.y * to_trust), trust.rows - 1),
                        std::min(static_cast<int>(p.x * to_trust), trust.cols - 1));
    const float z = smooth_depth(previous_depth_, p, depth_reach_);
    if (weight <= 0.0F || z <= 0.0F || q.x < 0 || q.y < 0 || q.x >= previous_depth_.cols ||
        q.y >= previous_depth_.rows) {
      continue;
    }
    previous_pixels.push_back(p);
    current_pixels.push_back(q);
    depths.push_back(z);
    weights.push_back(weight);
  }
  previous_pixels = camera_.undistort(previous_pixels);
  current_pixels = camera_.undistort(current_pixels);
  std::vector<Match> matches(depths.size());
  for (std::size_t i = 0; i < depths.size(); ++i) {
    matches[i].point = camera_.unproject({previous_pixels[i].x, previous_pixels[i].y}, depths[i]);
    matches[i].pixel = {current_pixels[i].x, current_pixels[i].y};
    matches[i].weight = weights[i];
  }
  return matches;
}

EgoMotion EgoMotionEstimator::solve(const std::vector<Match>& matches) const {
  EgoMotion motion;
  if (static_cast<int>(matches.size()) < options_.min_points) return motion;
  // From coarse to fine, from a kernel as wide as the start may be off.
  const auto settle = [&](Se3 start, double widest, const Se3* expected) {
    for (double scale = widest; scale > options_.inlier_pixels; scale *= 0.5) {
      start = refine(matches, start, expected, scale, 4);
    }
    return refine(matches, start, expected, options_.inlier_pixels, 6);
  };
  // The camera hardly changes its motion from frame to frame. A wide kernel would let people in: a
  // few moving surfaces and a still wall together look like a turn with a shift.
  for (double widest : {2.0 * options_.inlier_pixels, 8.0 * options_.inlier_pixels}) {
    const Se3 found = settle(last_motion_, widest, &last_motion_);
    const double share = inlier_share(matches, found);
    if (share > motion.inlier_share) {
      motion.current_from_previous = found;
      motion.inlier_share = share;
    }
    if (motion.inlier_share >= options_.min_inlier_share) break;
  }
  if (motion.inlier_share < options_.min_inlier_share) {
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (const Match& m : matches) {
      points.emplace_back(m.point.x(), m.point.y(), m.point.z());
      pixels.emplace_back(m.pixel.x(), m.pixel.y());
    }
    cv::Vec3d rotation, translation;
    // OpenCV seeds this RANSAC with a constant: the same matches give the same motion.
    if (cv::solvePnPRansac(points, pixels, camera_.matrix(), cv::noArray(), rotation, translation,
                           false, 100, static_cast<float>(2.0 * options_.inlier_pixels), 0.99,
                           cv::noArray(), cv::SOLVEPNP_P3P)) {
      const Eigen::Vector3d axis(rotation[0], rotation[1], rotation[2]);
      const double angle = axis.norm();
      const Eigen::Vector3d direction =
          angle > 0.0 ? Eigen::Vector3d(axis / angle) : Eigen::Vector3d::UnitX();
      const Se3 other = settle({Eigen::Quaterniond(Eigen::AngleAxisd(angle, direction)),
                                {translation[0], translation[1], translation[2]}},
                               2.0 * options_.inlier_pixels, nullptr);
      const double share = inlier_share(matches, other);
      // Another motion must explain clearly more than the one that continues the last.
      if (share > 1.3 * motion.inlier_share) {
        motion.current_from_previous = other;
        motion.inlier_share = share;
      }
    }
  }
  motion.valid = motion.inlier_share * static_cast<double>(matches.size()) >= options_.min_points;
  return motion;
}

Se3 EgoMotionEstimator::refine(const std::vector<Match>& matches, const Se3& start,
                               const Se3* expected, double scale, int iterations) const {
  Se3 motion = start;
  for (int i = 0; i < iterations; ++i) {
    Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Identity() * 1e-6;
    Vector6d gradient = Vector6d::Zero();
    for (const Match& m : matches) {
      const Eigen::Vector3d p = motion * m.point;
      if (p.z() < 0.1) continue;
      const Eigen::Vector2d error = camera_.project(p) - m.pixel;
      const double relative = error.squaredNorm() / (scale * scale);
      const double weight = m.weight / ((1.0 + relative) * (1.0 + relative));  // Geman-McClure
      Eigen::Matrix<double, 2, 3> by_point;
      by_point << camera_.fx / p.z(), 0.0, -camera_.fx * p.x() / (p.z() * p.z()), 0.0,
          camera_.fy / p.z(), -camera_.fy * p.y() / (p.z() * p.z());
      Eigen::Matrix<double, 2, 6> jacobian;
      jacobian << by_point, -by_point * skew(p);
      hessian += weight * jacobian.transpose() * jacobian;
      gradient += weight * jacobian.transpose() * error;
    }
    if (expected != nullptr) {
      const Vector6d change = (motion * expected->inverse()).log();
      Vector6d information;
      information << Eigen::Vector3d::Constant(std::pow(options_.usual_shift, -2)),
          Eigen::Vector3d::Constant(std::pow(options_.usual_turn, -2));
      hessian.diagonal() += information;
      gradient += information.cwiseProduct(change);
    }
    const Vector6d step = -hessian.ldlt().solve(gradient);
    if (!step.allFinite()) return start;
    motion = Se3::exp(step) * motion;
    if (step.norm() < 1e-6) break;
  }
  return motion;
}

double EgoMotionEstimator::inlier_share(const std::vector<Match>& matches,
                                        const Se3& motion) const {
  double inliers = 0.0, all = 0.0;
  for (const Match& m : matches) {
    const Eigen::Vector3d p = motion * m.point;
    all += m.weight;
    if (p.z() > 0.1 && (camera_.project(p) - m.pixel).norm() < options_.inlier_pixels) {
      inliers += m.weight;
    }
  }
  return all > 0.0 ? inliers / all : 0.0;
}

}  // namespace dkp_slam
