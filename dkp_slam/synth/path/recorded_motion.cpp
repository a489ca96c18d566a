#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/synth/path/motion.h"
#include "dkp_slam/synth/path/pose_spline.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;
/// Position and quaternion, to be averaged as one.
using Pose7 = Eigen::Matrix<double, 7, 1>;

constexpr double knot_interval = 0.02;     // seconds
constexpr double smoothing = 0.025;        // seconds; motion capture at 100 Hz jitters by 1 mrad
constexpr double shortest = 1.0;           // seconds
constexpr double widest_interval = 1.0;    // seconds from pose to pose on the average
constexpr double notable_gap = 0.5;        // seconds
constexpr double least_uprightness = 0.5;  // of the mean upward direction: 60 degrees off

// The part of the office that is free for a camera: the walls are at x = -2.7 and 2.7, y = -2.4,
// the desk begins at y = 1.65.
const Vector3d free_from(-2.3, -2.1, 0.4), free_to(2.3, 1.2, 2.4);

struct Sample {
  double time = 0.0;  ///< seconds from the first
  Pose7 pose;
};

Se3 pose_of(const Pose7& p) {
  const Eigen::Quaterniond rotation(Eigen::Vector4d(p.tail<4>()));
  return {rotation.normalized(), p.head<3>()};
}

std::vector<Sample> samples_of(const Trajectory& poses) {
  std::vector<Sample> samples;
  for (const StampedPose& p : poses) {
    Sample s;
    s.time = p.timestamp - poses.front().timestamp;
    s.pose << p.world_from_camera.translation, p.world_from_camera.rotation.coeffs();
    // q and -q are the same rotation; neighbours must lie on the same half of the sphere.
    if (!samples.empty() && s.pose.tail<4>().dot(samples.back().pose.tail<4>()) < 0.0) {
      s.pose.tail<4>() *= -1.0;
    }
    samples.push_back(s);
  }
  return samples;
}

/// The samples as a function of time: locally a straight line, fitted with Gaussian weights.
class Smoother {
 public:
  explicit Smoother(std::vector<Sample> samples) : samples_(std::move(samples)) {
    std::vector<double> intervals;
    for (std::size_t i = 1; i < samples_.size(); ++i) {
      intervals.push_back(samples_[i].time - samples_[i - 1].time);
    }
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    sigma_ = std::max(smoothing, *middle);
  }

  /// Nothing in a gap.
  std::optional<Pose7> at(double time) const {
    const double reach = 3.0 * sigma_;
    const auto earlier = [](const Sample& s, double t) { return s.time < t; };
    const auto begin = std::lower_bound(samples_.begin(), samples_.end(), time - reach, earlier);
    const auto end = std::lower_bound(begin, samples_.end(), time + reach, earlier);
    if (begin == end || begin->time > time || (end - 1)->time < time) {
      // The ends themselves are known.
      if (time > samples_.front().time && time < samples_.back().time) return std::nullopt;
    }
    double w = 0.0, wt = 0.0, wtt = 0.0;
    Pose7 wp = Pose7::Zero(), wtp = Pose7::Zero();
    for (auto s = begin; s != end; ++s) {
      const double t = s->time - time;
      const double weight = std::exp(-0.5 * t * t / (sigma_ * sigma_));
      w += weight;
      wt += weight * t;
      wtt += weight * t * t;
      wp += weight * s->pose;
      wtp += weight * t * s->pose;
    }
    const double determinant = w * wtt - wt * wt;
    // One sample in reach, or several at one time.
    if (determinant < 1e-9 * sigma_ * sigma_) return wp / w;
    return (wtt * wp - wt * wtp) / determinant;
  }

 private:
  std::vector<Sample> samples_;
  double sigma_;  ///< seconds
};

/// Bridges the run of unknown knots [first, last) by a cubic curve that leaves and arrives with the
/// speeds of its ends.
void bridge(std::vector<std::optional<Pose7>>& knots, std::size_t first, std::size_t last) {
  // The spline's own smoothing reaches two knots far; so are the speeds taken.
  constexpr std::size_t run = 3;
  const auto speed = [&](std::size_t from, std::size_t to) -> Pose7 {
    if (!knots[from] || !knots[to] || from == to) return Pose7::Zero();
    return (*knots[to] - *knots[from]) / static_cast<double>(to - from);
  };
  const std::size_t a = first - 1, b = last;
  const double n = static_cast<double>(b - a);
  const Pose7 leaving = n * speed(a >= run ? a - run : 0, a);
  const Pose7 arriving = n * speed(b, std::min(b + run, knots.size() - 1));
  for (std::size_t i = first; i < last; ++i) {
    const double u = static_cast<double>(i - a) / n, v = 1.0 - u;
    knots[i] = v * v * (1.0 + 2.0 * u) * *knots[a] + u * v * v * leaving +
               u * u * (1.0 + 2.0 * v) * *knots[b] - u * u * v * arriving;
  }
}

std::vector<Se3> knots_of(const Trajectory& poses) {
  const Smoother smoother(samples_of(poses));
  const double duration = poses.back().timestamp - poses.front().timestamp;
  const auto count = static_cast<std::size_t>(duration / knot_interval) + 1;
  std::vector<std::optional<Pose7>> knots;
  for (std::size_t i = 0; i < count; ++i) {
    knots.push_back(smoother.at(std::min(static_cast<double>(i) * knot_interval, duration)));
  }
  if (!knots.back()) knots.back() = smoother.at(duration);
  for (std::size_t i = 1; i < count; ++i) {
    if (knots[i]) continue;
    std::size_t end = i;
    while (!knots[end]) ++end;
    bridge(knots, i, end);
    i = end;
  }
  std::vector<Se3> path;
  for (const std::optional<Pose7>& knot : knots) path.push_back(pose_of(*knot));
  return path;
}

void check_sampling(const Trajectory& poses, const std::string& name) {
  const double duration = poses.empty() ? 0.0 : poses.back().timestamp - poses.front().timestamp;
  if (duration < shortest) {
    throw Error(fmt::format("{}: the path lasts {:.2f} s; it must last {:.0f} s or longer", name,
                            duration, shortest));
  }
  if (duration / static_cast<double>(poses.size() - 1) > widest_interval) {
    throw Error(fmt::format("{}: {} poses in {:.0f} s are too few; one a second at least", name,
                            poses.size(), duration));
  }
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double gap = poses[i].timestamp - poses[i - 1].timestamp;
    if (gap > notable_gap) {
      spdlog::warn("{}: no pose for {:.2f} s from {:.6f} on; bridged", name, gap,
                   poses[i - 1].timestamp);
    }
  }
}

/// The rigid motion about the vertical that brings the path's mean place and heading to `at`.
Se3 placement(const std::vector<Se3>& path, const Standpoint& at, const std::string& name) {
  Vector3d centre = Vector3d::Zero(), ahead = Vector3d::Zero(), up = Vector3d::Zero();
  for (const Se3& pose : path) {
    centre += pose.translation / static_cast<double>(path.size());
    ahead += pose.rotation * Vector3d::UnitZ() / static_cast<double>(path.size());
    up -= pose.rotation * Vector3d::UnitY() / static_cast<double>(path.size());
  }
  if (up.z() < least_uprightness) {
    throw Error(fmt::format(
        "{}: the camera's upper side points to ({:.2f}, {:.2f}, {:.2f}) on the average; the path "
        "must be in a world with z up (a motion capture's, not a camera's first frame)",
        name, up.x(), up.y(), up.z()));
  }
  const double heading = std::atan2(-ahead.x(), ahead.y());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(at.heading - heading, Vector3d::UnitZ()));
  return {turn, at.position - turn * centre};
}

void check_room(const std::vector<Se3>& path, const std::string& name) {
  Vector3d low = path.front().translation, high = low;
  for (const Se3& pose : path) {
    low = low.cwiseMin(pose.translation);
    high = high.cwiseMax(pose.translation);
  }
  if ((low.array() >= free_from.array()).all() && (high.array() <= free_to.array()).all()) return;
  throw Error(fmt::format(
      "{}: the path does not fit the office: it reaches from ({:.2f}, {:.2f}, {:.2f}) to ({:.2f}, "
      "{:.2f}, {:.2f}) m there, free are ({:.1f}, {:.1f}, {:.1f}) to ({:.1f}, {:.1f}, {:.1f}) m",
      name, low.x(), low.y(), low.z(), high.x(), high.y(), high.z(), free_from.x(), free_from.y(),
      free_from.z(), free_to.x(), free_to.y(), free_to.z()));
}

}  // namespace

RecordedMotion recorded_motion(const Trajectory& poses, const std::string& name,
                               const Standpoint& at) {
  check_sampling(poses, name);
  std::vector<Se3> path = knots_of(poses);
  const Se3 place = placement(path, at, name);
  for (Se3& pose : path) pose = place * pose;
  check_room(path, name);
  const auto spline = std::make_shared<const PoseSpline>(std::move(path), knot_interval);
  return {[spline](double time) { return spline->at(time); },
          poses.back().timestamp - poses.front().timestamp};
}

RecordedMotion recorded_motion(const std::filesystem::path& file, const Standpoint& at) {
  return recorded_motion(read_trajectory(file), file.string(), at);
}

}  // namespace dkp_slam
