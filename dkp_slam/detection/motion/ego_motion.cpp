#include "dkp_slam/detection/motion/ego_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "dkp_slam/geometry/rolling_shutter.h"
#include "dkp_slam/geometry/sensor_scale.h"

namespace dkp_slam {
namespace {

const cv::Size window(11, 11);
constexpr int pyramid_levels = 3;
constexpr double nearest = 0.1;  // metres before the camera; what is nearer is not seen

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
      depth_reach_(std::max(1, cvRound(3.0 * SensorScale::of(camera).pixels))),
      coarse_rotation_(camera) {}

EgoMotion EgoMotionEstimator::update(const cv::Mat& grey, const cv::Mat& depth,
                                     const cv::Mat& trust, double seconds) {
  cv::Mat small;
  cv::resize(grey, small, grey.size() / shrink_, 0, 0, cv::INTER_AREA);
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(small, pyramid, window, pyramid_levels);
  coarse_rotation_.push(grey, {});
  EgoMotion motion;
  if (!previous_pyramid_.empty()) {
    expect(seconds);
    motion = solve(track(pyramid, trust));
    go_on_from(motion);
  }
  previous_pyramid_ = std::move(pyramid);
  previous_small_ = small;
  previous_depth_ = depth;
  return motion;
}

void EgoMotionEstimator::go_on_from(EgoMotion& motion) {
  const bool known = motion.valid && seconds_ > 0.0;
  if (known) {
    const Vector6d mean = motion.current_from_previous.log() / seconds_;
    motion.velocity = motion.previous_velocity = mean;
    if (last_seconds_ > 0.0) {
      const Vector6d half_a_change = 0.5 * (mean - last_velocity_);
      motion.velocity += half_a_change;
      motion.previous_velocity -= half_a_change;
    }
    last_velocity_ = mean;
  }
  last_share_ = motion.inlier_share;
  last_seconds_ = known ? seconds_ : 0.0;
}

// A hand goes on as it did for a frame or two. After a longer gap nobody knows, and a prediction of
// five frames would be worse than none.
void EgoMotionEstimator::expect(double seconds) {
  constexpr double frames_ahead = 2.0;
  seconds_ = std::max(0.0, seconds);
  turn_ = coarse_rotation_.previous_from_current();
  if (turn_) turn_ = turn_->conjugate();
  if (last_seconds_ == 0.0) last_velocity_.setZero();
  expected_ = Se3::exp(last_velocity_ * std::min(seconds_, frames_ahead * last_seconds_));
}

// What few points agreed on may have been people's motion, and must not become the expected one.
double EgoMotionEstimator::doubt() const {
  constexpr double nothing_known = 6.0;  // a hand may be at 2 m/s and 1 rad/s
  if (last_seconds_ <= 0.0) return nothing_known;
  constexpr double most = 3.0;
  const double few = options_.min_inlier_share / std::max(0.01, last_share_);
  return std::max(1.0, seconds_ / last_seconds_) * std::clamp(few, 1.0, most);
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

/// Corners of the small image where a camera that has but turned sees them now.
std::vector<cv::Point2f> EgoMotionEstimator::turned(const std::vector<cv::Point2f>& corners) const {
  const Eigen::Matrix3d rotation = turn_->toRotationMatrix();
  const double fx = camera_.fx / shrink_, fy = camera_.fy / shrink_;
  const double cx = (camera_.cx + 0.5) / shrink_ - 0.5, cy = (camera_.cy + 0.5) / shrink_ - 0.5;
  std::vector<cv::Point2f> all;
  for (const cv::Point2f& p : corners) {
    const Eigen::Vector3d ray((static_cast<double>(p.x) - cx) / fx,
                              (static_cast<double>(p.y) - cy) / fy, 1.0);
    const Eigen::Vector3d now = rotation * ray;
    all.emplace_back(static_cast<float>(fx * now.x() / now.z() + cx),
                     static_cast<float>(fy * now.y() / now.z() + cy));
  }
  return all;
}

/// With s and t, in frame intervals, the delays of the two rows, and a velocity that changes
/// evenly: the integral of the velocity from -1 + s to t.
void EgoMotionEstimator::set_moments(Match& match, float previous_row, float current_row) const {
  if (seconds_ <= 0.0) return;
  const double s = row_delay(camera_, static_cast<double>(previous_row)) / seconds_;
  const double t = row_delay(camera_, static_cast<double>(current_row)) / seconds_;
  match.of_motion = t - s;
  if (last_seconds_ > 0.0) match.of_change = 0.5 * (t * t - s * s + s + t);
}

std::vector<EgoMotionEstimator::Match> EgoMotionEstimator::track(
    const std::vector<cv::Mat>& pyramid, const cv::Mat& trust) const {
  const std::vector<cv::Point2f> from = corners();
  if (from.empty()) return {};
  std::vector<cv::Point2f> to = turn_ ? turned(from) : from;
  std::vector<uchar> found;
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01);
  cv::calcOpticalFlowPyrLK(previous_pyramid_, pyramid, from, to, found, cv::noArray(), window,
                           pyramid_levels, enough, cv::OPTFLOW_USE_INITIAL_FLOW);
  // Pixels of the small image sit between those of the full one.
  const auto step = static_cast<float>(shrink_);
  const auto to_full = [step](const cv::Point2f& p) {
    const float centre = 0.5F * (step - 1.0F);
    return cv::Point2f(step * p.x + centre, step * p.y + centre);
  };
  std::vector<cv::Point2f> previous_pixels, current_pixels;
  std::vector<float> depths, weights;
  std::vector<std::pair<float, float>> rows;
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
    rows.emplace_back(p.y, q.y);
    weights.push_back(weight);
  }
  previous_pixels = camera_.undistort(previous_pixels);
  current_pixels = camera_.undistort(current_pixels);
  std::vector<Match> matches(depths.size());
  for (std::size_t i = 0; i < depths.size(); ++i) {
    matches[i].point = camera_.unproject({previous_pixels[i].x, previous_pixels[i].y}, depths[i]);
    matches[i].pixel = {current_pixels[i].x, current_pixels[i].y};
    matches[i].weight = weights[i];
    set_moments(matches[i], rows[i].first, rows[i].second);
  }
  return matches;
}

EgoMotion EgoMotionEstimator::solve(const std::vector<Match>& matches) const {
  EgoMotion motion;
  if (static_cast<int>(matches.size()) < options_.min_points) return motion;
  double least = std::numeric_limits<double>::max();
  const auto try_from = [&](const Se3& start, double widest) {
    if (motion.inlier_share >= options_.min_inlier_share) return;
    const Se3 found = settle(matches, start, widest);
    const double found_cost = cost(matches, found);
    if (found_cost >= least) return;
    least = found_cost;
    motion.current_from_previous = found;
    motion.inlier_share = inlier_share(matches, found);
  };
  // A wide kernel lets people in: a few moving surfaces and a still wall together look like a turn
  // with a shift.
  const double narrow = 2.0 * options_.inlier_pixels, wide = 8.0 * options_.inlier_pixels;
  try_from(expected_, narrow);
  try_from(expected_, wide);
  if (turn_) {
    const Se3 turned(*turn_, Eigen::Vector3d::Zero());
    try_from(turned, narrow);
    try_from(turned, wide);
  }
  motion.valid = motion.inlier_share * static_cast<double>(matches.size()) >= options_.min_points;
  return motion;
}

/// `tangent`: of `motion`, over the whole interval.
Se3 EgoMotionEstimator::motion_of(const Match& match, const Se3& motion,
                                  const Vector6d& tangent) const {
  if (match.of_motion == 0.0 && match.of_change == 0.0) return motion;
  const Vector6d change = tangent - seconds_ * last_velocity_;
  return Se3::exp(match.of_motion * tangent + match.of_change * change) * motion;
}

Se3 EgoMotionEstimator::settle(const std::vector<Match>& matches, Se3 start, double widest) const {
  for (double scale = widest; scale > options_.inlier_pixels; scale *= 0.5)
    start = refine(matches, start, scale, 4);
  return refine(matches, start, options_.inlier_pixels, 6);
}

Vector6d EgoMotionEstimator::usual_change() const {
  const double times = doubt();
  Vector6d change;
  change << Eigen::Vector3d::Constant(times * options_.usual_shift),
      Eigen::Vector3d::Constant(times * options_.usual_turn);
  return change;
}

double EgoMotionEstimator::squared_miss(const Match& match, const Se3& motion,
                                        const Vector6d& tangent) const {
  const Eigen::Vector3d p = motion_of(match, motion, tangent) * match.point;
  if (p.z() < nearest) return std::numeric_limits<double>::max();
  return (camera_.project(p) - match.pixel).squaredNorm();
}

double EgoMotionEstimator::cost(const std::vector<Match>& matches, const Se3& motion) const {
  const Vector6d tangent = motion.log();
  const double scale = options_.inlier_pixels;
  const Vector6d change = (motion * expected_.inverse()).log().cwiseQuotient(usual_change());
  double cost = change.squaredNorm() / (scale * scale);
  for (const Match& m : matches) {
    const double relative = squared_miss(m, motion, tangent) / (scale * scale);
    cost += m.weight * relative / (1.0 + relative);  // Geman-McClure
  }
  return cost;
}

Se3 EgoMotionEstimator::refine(const std::vector<Match>& matches, const Se3& start, double scale,
                               int iterations) const {
  const Vector6d information = usual_change().array().square().inverse();
  Se3 motion = start;
  for (int i = 0; i < iterations; ++i) {
    const Vector6d tangent = motion.log();
    Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Identity() * 1e-6;
    Vector6d gradient = Vector6d::Zero();
    for (const Match& m : matches) {
      const Eigen::Vector3d p = motion_of(m, motion, tangent) * m.point;
      if (p.z() < nearest) continue;
      const Eigen::Vector2d error = camera_.project(p) - m.pixel;
      const double relative = error.squaredNorm() / (scale * scale);
      const double weight = m.weight / ((1.0 + relative) * (1.0 + relative));  // Geman-McClure
      Eigen::Matrix<double, 2, 3> by_point;
      by_point << camera_.fx / p.z(), 0.0, -camera_.fx * p.x() / (p.z() * p.z()), 0.0,
          camera_.fy / p.z(), -camera_.fy * p.y() / (p.z() * p.z());
      Eigen::Matrix<double, 2, 6> jacobian;
      jacobian << by_point, -by_point * skew(p);
      jacobian *= 1.0 + m.of_motion + m.of_change;
      hessian += weight * jacobian.transpose() * jacobian;
      gradient += weight * jacobian.transpose() * error;
    }
    const Vector6d change = (motion * expected_.inverse()).log();
    hessian.diagonal() += information;
    gradient += information.cwiseProduct(change);
    const Vector6d step = -hessian.ldlt().solve(gradient);
    if (!step.allFinite()) return start;
    motion = Se3::exp(step) * motion;
    if (step.norm() < 1e-6) break;
  }
  return motion;
}

double EgoMotionEstimator::inlier_share(const std::vector<Match>& matches,
                                        const Se3& motion) const {
  const Vector6d tangent = motion.log();
  double inliers = 0.0, all = 0.0;
  for (const Match& m : matches) {
    all += m.weight;
    if (std::sqrt(squared_miss(m, motion, tangent)) < options_.inlier_pixels) inliers += m.weight;
  }
  return all > 0.0 ? inliers / all : 0.0;
}

}  // namespace dkp_slam
