#include "dkp_slam/dynamics/motion/feature_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dkp_slam/geometry/depth_at.h"
#include "dkp_slam/geometry/rolling_shutter.h"

namespace dkp_slam {
namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
constexpr double typical_depth = 3.0;  // metres: what has no depth is mostly far

/// Nearest and farthest known depth within `reach` pixels; {0, 0} where there is none.
std::pair<double, double> depths_around(const cv::Mat& depth, const cv::Point2f& p, float reach) {
  double near = 0.0, far = 0.0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const double z = static_cast<double>(
          depth_at(depth, p + reach * cv::Point2f(static_cast<float>(dx), static_cast<float>(dy))));
      if (z <= 0.0) continue;
      near = near > 0.0 ? std::min(near, z) : z;
      far = std::max(far, z);
    }
  }
  return {near, far};
}

Eigen::Vector2d vector_of(const cv::Point2f& p) { return {p.x, p.y}; }

}  // namespace

/// The camera's velocity at a step's moment, tangent per second: the mean of the motions into it
/// and out of it, for the newest step extrapolated from the last two. Zero where none is known.
Vector6d FeatureMotionEstimator::velocity_at(std::size_t step) const {
  const auto into = [&](std::size_t k) -> std::optional<Vector6d> {
    if (k + 1 >= steps_.size() || !steps_[k].previous_from_this) return std::nullopt;
    const double passed = steps_[k].time - steps_[k + 1].time;
    if (passed <= 0.0) return std::nullopt;
    return steps_[k].previous_from_this->inverse().log() / passed;
  };
  const std::optional<Vector6d> here = into(step);
  if (step == 0) {
    const std::optional<Vector6d> before = into(1);
    if (here && before) return *here + 0.5 * (*here - *before);
    return here ? *here : before ? *before : Vector6d::Zero();
  }
  const std::optional<Vector6d> next = into(step - 1);
  if (here && next) return 0.5 * (*here + *next);
  return here ? *here : next ? *next : Vector6d::Zero();
}

/// Raw pixels of a step's image, `seen` undistorted, as at its middle row's moment; their depths
/// are read from the newest depth image at `depth_from`.
std::vector<cv::Point2f> FeatureMotionEstimator::straight(
    const std::vector<cv::Point2f>& raw, const std::vector<cv::Point2f>& seen, const cv::Mat& depth,
    const std::vector<cv::Point2f>& depth_from, std::size_t step) const {
  std::vector<cv::Point2f> flat = seen;
  if (camera_.readout <= 0.0) return flat;
  const Vector6d velocity = velocity_at(step);
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const ImagePoint there{flat[i], depth_at(depth, depth_from[i])};
    flat[i] = at_middle_row(camera_, there, raw[i].y, velocity).pixel;
  }
  return flat;
}

/// The previous frame's camera from this one's, before any flow is known: it goes on as it moved;
/// but over a gap, or when nobody knows how it moved, small images tell better how it has turned.
std::optional<ExpectedMotion> FeatureMotionEstimator::expect() const {
  const double passed = steps_.size() < 2 ? 0.0 : steps_[0].time - steps_[1].time;
  if (passed <= 0.0) return std::nullopt;
  ExpectedMotion expected;
  // The newest motion that was told: from one that was not believed on, the hand has had more time.
  constexpr double longest = 0.3;  // seconds
  std::size_t told = 1;
  while (told + 1 < steps_.size() && !steps_[told].previous_from_this) ++told;
  const double since = steps_[0].time - steps_[told].time;
  const bool known = told + 1 < steps_.size() && since < longest;
  const double free = known ? since : passed;
  expected.translation_sigma = options_.motion.acceleration * free * passed;
  expected.rotation_sigma = options_.motion.angular_acceleration * free * passed;
  if (known) {
    const double before = steps_[told].time - steps_[told + 1].time;
    expected.previous_from_current =
        Se3::exp(passed / before * steps_[told].previous_from_this->log());
  }
  constexpr double coarse = 0.01;  // radians: sigma of the turn that small images tell
  if (known && expected.rotation_sigma < 2.0 * coarse) return expected;
  const auto turn = options_.coarse_rotation ? coarse_rotation_.previous_from_current()
                                             : std::optional<Eigen::Quaterniond>();
  if (!turn) return known ? std::optional(expected) : std::nullopt;
  expected.previous_from_current.rotation = *turn;
  expected.rotation_sigma = coarse;
  constexpr double walking = 0.5;  // m/s
  if (!known) expected.translation_sigma = walking * passed;
  return expected;
}

/// Whether somebody who carries the camera could have moved it so from the frame before.
bool FeatureMotionEstimator::could_be_carried(const Se3& motion) const {
  constexpr double fastest = 4.0, fastest_turn = 10.0;  // m/s, rad/s
  const double passed = steps_.size() < 2 ? 0.0 : steps_[0].time - steps_[1].time;
  if (passed <= 0.0) return true;
  return motion.translation.norm() <= fastest * passed && motion.angle() <= fastest_turn * passed;
}

std::vector<cv::Point2f> FeatureMotionEstimator::predict(
    const cv::Mat& depth, const std::vector<cv::Point2f>& points,
    const std::vector<cv::Point2f>& flat) const {
  const std::optional<ExpectedMotion> expected = expect();
  if (!expected) return points;
  const Se3& previous_from_this = expected->previous_from_current;
  std::vector<cv::Point2f> guess = points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double known = static_cast<double>(depth_at(depth, points[i]));
    const double z = known > 0.0 ? known : typical_depth;
    const Eigen::Vector3d q = previous_from_this * camera_.unproject(vector_of(flat[i]), z);
    if (q.z() < camera_.min_depth) continue;
    const Eigen::Vector2d raw = camera_.distort(camera_.project(q));
    if (raw.x() < 0 || raw.y() < 0 || raw.x() >= depth.cols || raw.y() >= depth.rows) continue;
    guess[i] = {static_cast<float>(raw.x()), static_cast<float>(raw.y())};
  }
  return guess;
}

/// Of points of the newest frame that were not followed yet.
FeatureMotion FeatureMotionEstimator::unmeasured(const cv::Mat& depth,
                                                 const std::vector<cv::Point2f>& points) const {
  FeatureMotion motion;
  motion.seen_now = camera_.undistort(points);
  motion.now = straight(points, motion.seen_now, depth, points, 0);
  motion.tracks.previous = points;
  motion.tracks.tracked.assign(points.size(), 0);
  motion.seen_then = motion.seen_now;
  motion.followed.assign(points.size(), 0);
  motion.residual.assign(points.size(), unknown);
  motion.prediction_sigma.assign(points.size(), 0.0F);
  motion.long_residual.assign(points.size(), unknown);
  return motion;
}

FeatureMotion FeatureMotionEstimator::track(const cv::Mat& grey, const cv::Mat& depth,
                                            const std::vector<cv::Point2f>& points,
                                            const std::vector<cv::Rect2f>& hidden,
                                            const std::vector<std::uint8_t>& wanted, double time) {
  flow_.push(grey);
  if (options_.coarse_rotation) coarse_rotation_.push(grey, hidden);
  steps_.push_front({time, std::nullopt});
  while (static_cast<int>(steps_.size()) > options_.flow.history + 1) steps_.pop_back();
  FeatureMotion motion = unmeasured(depth, points);
  follow(depth, points, wanted, motion);
  motion.then = straight(motion.tracks.previous, motion.seen_then, depth, points, 1);
  return motion;
}

/// Flow of the features that are wanted and were not followed yet; false where there are none.
bool FeatureMotionEstimator::follow(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                                    const std::vector<std::uint8_t>& wanted,
                                    FeatureMotion& motion) const {
  std::vector<std::size_t> index;
  std::vector<cv::Point2f> from, flat;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((!wanted.empty() && wanted[i] == 0) || motion.followed[i] != 0) continue;
    motion.followed[i] = 1;
    index.push_back(i);
    from.push_back(points[i]);
    flat.push_back(motion.now[i]);
  }
  if (index.empty() || flow_.earlier_frames() == 0) return false;
  const FlowResult found = flow_.track(from, 1, predict(depth, from, flat));
  const std::vector<cv::Point2f> seen = camera_.undistort(found.previous);
  for (std::size_t k = 0; k < index.size(); ++k) {
    motion.tracks.previous[index[k]] = found.previous[k];
    motion.tracks.tracked[index[k]] = found.tracked[k];
    motion.seen_then[index[k]] = seen[k];
  }
  return true;
}

void FeatureMotionEstimator::follow_more(const cv::Mat& depth,
                                         const std::vector<cv::Point2f>& points,
                                         const std::vector<std::uint8_t>& wanted,
                                         FeatureMotion& motion) const {
  if (!follow(depth, points, wanted, motion)) return;
  motion.then = straight(motion.tracks.previous, motion.seen_then, depth, points, 1);
  if (motion.camera_motion) fill_residuals(depth, points, motion);
}

FeatureMotion FeatureMotionEstimator::measure(
    const cv::Mat& depth, const std::vector<cv::Point2f>& points,
    const std::optional<CameraMotion>& camera_motion) const {
  FeatureMotion motion = unmeasured(depth, points);
  motion.camera_motion = camera_motion;
  follow_more(depth, points, {}, motion);
  return motion;
}

double FeatureMotionEstimator::residual_at(const cv::Mat& depth, const cv::Point2f& raw,
                                           const cv::Point2f& now, const cv::Point2f& then,
                                           const cv::Point2f& flow,
                                           const Se3& then_from_now) const {
  const double reach = std::clamp(options_.depth_lag * std::hypot(flow.x, flow.y),
                                  options_.min_lag_pixels, options_.max_lag_pixels);
  auto [near, far] = depths_around(depth, raw, static_cast<float>(reach));
  if (near <= 0.0) {
    near = camera_.min_depth;
    far = std::numeric_limits<double>::infinity();
  }
  return motion_residual_between(camera_, then_from_now, vector_of(now), vector_of(then), near,
                                 far);
}

Se3 FeatureMotionEstimator::current_from_previous() const {
  for (std::size_t k = 0; k < 2 && k < steps_.size(); ++k) {
    if (steps_[k].previous_from_this) return steps_[k].previous_from_this->inverse();
  }
  return {};
}

/// The features flagged low that have a depth, or all of them where those are too few.
std::vector<MotionPoint> FeatureMotionEstimator::motion_points(
    const cv::Mat& depth, const std::vector<cv::Point2f>& points,
    const std::vector<std::uint8_t>& low, FeatureMotion& motion) const {
  std::vector<MotionPoint> low_points, all_points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (motion.tracks.tracked[i] == 0) continue;
    const auto z = static_cast<double>(depth_at(depth, points[i]));
    if (z <= 0.0) continue;
    const MotionPoint observed{camera_.unproject(vector_of(motion.now[i]), z),
                               vector_of(motion.then[i])};
    all_points.push_back(observed);
    if (low[i] != 0) low_points.push_back(observed);
  }
  motion.from_low_points = static_cast<int>(low_points.size()) >= options_.min_low_points;
  return motion.from_low_points ? low_points : all_points;
}

void FeatureMotionEstimator::measure_ego_motion(const cv::Mat& depth,
                                                const std::vector<cv::Point2f>& points,
                                                const std::vector<std::uint8_t>& low,
                                                std::uint64_t seed, FeatureMotion& motion) {
  const std::optional<ExpectedMotion> known = expect();
  const ExpectedMotion expected = known.value_or(ExpectedMotion());
  motion.camera_motion = estimate_motion(camera_, motion_points(depth, points, low, motion),
                                         expected, options_.motion, seed);
  if (!motion.camera_motion) return;
  if (!known && !could_be_carried(motion.camera_motion->previous_from_current)) {
    motion.camera_motion.reset();
    return;
  }
  steps_.front().previous_from_this = motion.camera_motion->previous_from_current;
  if (camera_.readout > 0.0) {
    // The motion tells what the rolling shutter did, and that refines the motion.
    motion.now = straight(points, motion.seen_now, depth, points, 0);
    motion.then = straight(motion.tracks.previous, motion.seen_then, depth, points, 1);
    const auto refined = refine_motion(camera_, motion_points(depth, points, low, motion), expected,
                                       *steps_.front().previous_from_this, options_.motion);
    if (refined) motion.camera_motion = refined;
    steps_.front().previous_from_this = motion.camera_motion->previous_from_current;
  }
  fill_residuals(depth, points, motion);
}

/// How many of the support were followed, and how many of these agree with the motion.
FeatureMotionEstimator::Agreement FeatureMotionEstimator::agreement(
    const std::vector<std::uint8_t>& support, const FeatureMotion& motion) const {
  Agreement count;
  for (std::size_t i = 0; i < support.size(); ++i) {
    if (support[i] == 0 || motion.tracks.tracked[i] == 0) continue;
    ++count.followed;
    const auto off = static_cast<double>(motion.residual[i]);  // NaN agrees with nothing
    count.agree += off < options_.motion.inlier_distance ? 1 : 0;
  }
  return count;
}

bool FeatureMotionEstimator::measure_ego_motion_anew(const cv::Mat& depth,
                                                     const std::vector<cv::Point2f>& points,
                                                     const std::vector<std::uint8_t>& support,
                                                     std::uint64_t seed, FeatureMotion& motion) {
  FeatureMotion anew = motion;
  const std::optional<Se3> before = steps_.front().previous_from_this;
  measure_ego_motion(depth, points, support, seed, anew);
  const auto [followed, agree] = agreement(support, anew);
  if (anew.camera_motion && anew.from_low_points && 2 * agree >= followed &&
      agree >= 2 * agreement(support, motion).agree) {
    motion = std::move(anew);
    return true;
  }
  steps_.front().previous_from_this = before;
  return false;
}

bool FeatureMotionEstimator::refine_ego_motion(const cv::Mat& depth,
                                               const std::vector<cv::Point2f>& points,
                                               const std::vector<std::uint8_t>& support,
                                               const std::vector<std::uint8_t>& more,
                                               FeatureMotion& motion) {
  std::vector<std::uint8_t> both = support;
  for (std::size_t i = 0; i < both.size(); ++i) both[i] |= more[i];
  FeatureMotion anew = motion;
  anew.camera_motion = refine_motion(camera_, motion_points(depth, points, both, anew),
                                     expect().value_or(ExpectedMotion()),
                                     motion.camera_motion->previous_from_current, options_.motion);
  if (!anew.camera_motion) return false;
  fill_residuals(depth, points, anew);
  if (agreement(support, anew).agree < agreement(support, motion).agree) return false;
  motion = std::move(anew);
  steps_.front().previous_from_this = motion.camera_motion->previous_from_current;
  return true;
}

void FeatureMotionEstimator::fill_residuals(const cv::Mat& depth,
                                            const std::vector<cv::Point2f>& points,
                                            FeatureMotion& motion) const {
  const Se3& previous_from_this = motion.camera_motion->previous_from_current;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (motion.tracks.tracked[i] == 0) continue;
    const cv::Point2f flow = motion.then[i] - motion.now[i];
    motion.residual[i] = static_cast<float>(
        residual_at(depth, points[i], motion.now[i], motion.then[i], flow, previous_from_this));
  }
}

void FeatureMotionEstimator::fill_prediction_sigma(const cv::Mat& depth,
                                                   const std::vector<cv::Point2f>& points,
                                                   FeatureMotion& motion) const {
  if (!motion.camera_motion) return;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (motion.tracks.tracked[i] == 0) continue;
    const auto known = static_cast<double>(depth_at(depth, points[i]));
    const Eigen::Vector3d point =
        camera_.unproject(vector_of(motion.now[i]), known > 0.0 ? known : typical_depth);
    motion.prediction_sigma[i] = static_cast<float>(
        options_.feature_sigma * prediction_sigma(camera_, *motion.camera_motion, point));
  }
}

void FeatureMotionEstimator::look_back(const cv::Mat& depth, const std::vector<cv::Point2f>& points,
                                       const std::vector<std::uint8_t>& wanted,
                                       FeatureMotion& motion) const {
  // Steps back whose age is nearest to the baseline, over a chain of known motions.
  Se3 earlier_from_now;
  int frames_back = 0;
  Se3 chain;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < steps_.size() && steps_[k].previous_from_this; ++k) {
    chain = *steps_[k].previous_from_this * chain;
    const double off = std::abs(steps_.front().time - steps_[k + 1].time - options_.long_baseline);
    if (off >= best) continue;
    best = off;
    frames_back = static_cast<int>(k) + 1;
    earlier_from_now = chain;
  }
  if (frames_back < 2) return;
  std::vector<cv::Point2f> from, guess;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float z = depth_at(depth, points[i]);
    if (wanted[i] == 0 || z <= 0.0F) continue;
    const Eigen::Vector3d q =
        earlier_from_now * camera_.unproject(vector_of(motion.now[i]), static_cast<double>(z));
    if (q.z() < camera_.min_depth) continue;
    const Eigen::Vector2d raw = camera_.distort(camera_.project(q));
    if (raw.x() < 0 || raw.y() < 0 || raw.x() >= depth.cols || raw.y() >= depth.rows) continue;
    from.push_back(points[i]);
    guess.emplace_back(static_cast<float>(raw.x()), static_cast<float>(raw.y()));
    index.push_back(i);
  }
  if (from.empty()) return;
  const FlowResult tracks = flow_.track(from, frames_back, guess);
  const std::vector<cv::Point2f> then =
      straight(tracks.previous, camera_.undistort(tracks.previous), depth, from,
               static_cast<std::size_t>(frames_back));
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (tracks.tracked[i] == 0) continue;
    // The lag is between images of one frame: flow per frame counts, not over the baseline.
    const cv::Point2f flow =
        (then[i] - motion.now[index[i]]) * (1.0F / static_cast<float>(frames_back));
    motion.long_residual[index[i]] = static_cast<float>(
        residual_at(depth, from[i], motion.now[index[i]], then[i], flow, earlier_from_now));
  }
}

}  // namespace dkp_slam
