#include "dkp_slam/calibration/window.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/Dense>

#include "dkp_slam/geometry/rolling_shutter.h"

namespace dkp_slam {
namespace {

constexpr double gap_frames = 6.0;  // without a frame: the motion in between is unknown
constexpr std::size_t least_frames = 12;

using Frames = std::span<const SightedFrame>;

/// The spline nearest to the frames' poses.
void fit_motion(Frames frames, Window& window) {
  MotionSpline& motion = window.motion;
  const int n = motion.size();
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(n, n), b = Eigen::MatrixXd::Zero(n, 6);
  for (const SightedFrame& frame : frames) {
    const Se3 pose = window.world_from_window.inverse() * frame.world_from_camera;
    const Eigen::AngleAxisd turn(pose.rotation);
    Vector6d value;
    value << turn.angle() * turn.axis(), pose.translation;
    const MotionSpline::Moment m = motion.moment(frame.time);
    const Eigen::Map<const Eigen::Vector4d> weight(m.weight.data());
    h.block<4, 4>(m.first, m.first) += weight * weight.transpose();
    b.middleRows<4>(m.first) += weight * value.transpose();
  }
  // Smooth where frames are missing: third differences are small.
  constexpr double stiffness = 1e-3;
  const Eigen::Vector4d third(-1.0, 3.0, -3.0, 1.0);
  for (int i = 0; i + 4 <= n; ++i) h.block<4, 4>(i, i) += stiffness * third * third.transpose();
  motion.controls = h.ldlt().solve(b).transpose();
}

/// In the window's frame, from all depths that were seen of it. False where there is none.
bool place_point(const std::vector<std::pair<const SightedFrame*, const SeenLandmark*>>& seen,
                 const Camera& camera, const Se3& window_from_world, Eigen::Vector3d& position) {
  std::vector<cv::Point2f> raw;
  for (const auto& [frame, s] : seen) {
    raw.emplace_back(static_cast<float>(s->pixel.x()), static_cast<float>(s->pixel.y()));
  }
  const std::vector<cv::Point2f> pixels = camera.undistort(raw);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto& [frame, s] = seen[i];
    if (!s->depth.known()) continue;
    sum += window_from_world * frame->world_from_camera *
           camera.unproject({pixels[i].x, pixels[i].y}, 1.0 / s->depth.inverse);
    ++count;
  }
  if (count == 0) return false;
  position = sum / count;
  return true;
}

void add_points(Frames frames, const Camera& camera, const WindowOptions& options, Window& window) {
  std::map<int, std::vector<std::pair<const SightedFrame*, const SeenLandmark*>>> by_landmark;
  for (const SightedFrame& frame : frames) {
    for (const SeenLandmark& s : frame.sightings) by_landmark[s.landmark].emplace_back(&frame, &s);
  }
  std::vector<std::pair<int, int>> order;  // fewer sightings last
  for (const auto& [landmark, seen] : by_landmark) {
    if (static_cast<int>(seen.size()) >= options.least_seen)
      order.emplace_back(-static_cast<int>(seen.size()), landmark);
  }
  std::sort(order.begin(), order.end());
  const Se3 window_from_world = window.world_from_window.inverse();
  for (const auto& [count, landmark] : order) {
    if (static_cast<int>(window.points.size()) == options.points) break;
    WindowPoint point;
    point.landmark = landmark;
    const auto& seen = by_landmark[landmark];
    if (!place_point(seen, camera, window_from_world, point.position)) continue;
    for (const auto& [frame, s] : seen) {
      const double row = s->pixel.y() / camera.height - 0.5;
      const auto row_delay = camera.depth_readout
                                 ? std::optional(depth_row_delay(camera, s->pixel.y()))
                                 : std::nullopt;
      point.seen.push_back({frame->time, frame->depth_time, row, s->pixel, s->sigma, s->depth,
                            row_delay,
                            DepthDistortion::terms(s->depth.pixel, {camera.width, camera.height})});
    }
    window.points.push_back(std::move(point));
  }
}

/// How much the speed changes in a window, radians per second: of the camera's turning, and of its
/// way as it is seen at two metres.
double change_of_speed(const Window& window) {
  constexpr double usual_depth = 2.0;
  Vector6d sum = Vector6d::Zero(), squares = Vector6d::Zero();
  int count = 0;
  for (double time = window.begin; time <= window.end; time += 0.02, ++count) {
    Vector6d rate = window.motion.rate(window.motion.moment(time));
    rate.tail<3>() /= usual_depth;
    sum += rate;
    squares += rate.cwiseAbs2();
  }
  return std::sqrt(std::max(0.0, (squares / count - (sum / count).cwiseAbs2()).sum()));
}

Window make_window(Frames frames, const Camera& camera, const WindowOptions& options) {
  Window window;
  window.begin = frames.front().time;
  window.end = frames.back().time;
  window.world_from_window = frames[frames.size() / 2].world_from_camera;
  const double step = 1.0 / camera.frame_rate;
  constexpr double margin = 0.05;  // seconds: rows and depth images before and after
  window.motion = MotionSpline(window.begin - margin, window.end + margin, step);
  fit_motion(frames, window);
  add_points(frames, camera, options, window);
  return window;
}

}  // namespace

std::vector<Window> make_windows(const std::vector<SightedFrame>& frames, const Camera& camera,
                                 const WindowOptions& options) {
  std::vector<Window> windows;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= frames.size(); ++i) {
    const bool gap =
        i == frames.size() || frames[i].time - frames[i - 1].time > gap_frames / camera.frame_rate;
    if (!gap && frames[i].time - frames[begin].time < options.length) continue;
    if (i - begin >= least_frames) {
      Window window = make_window(Frames(frames).subspan(begin, i - begin), camera, options);
      if (static_cast<int>(window.points.size()) >= options.least_points)
        windows.push_back(std::move(window));
    }
    begin = i;
  }
  const auto most = static_cast<std::size_t>(options.most_windows);
  if (windows.size() <= most) return windows;
  std::vector<double> changes;
  for (const Window& window : windows) changes.push_back(change_of_speed(window));
  std::vector<double> sorted = changes;
  std::nth_element(sorted.begin(), sorted.begin() + options.most_windows - 1, sorted.end(),
                   std::greater<>());
  const double least = sorted[most - 1];
  std::vector<Window> chosen;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (changes[i] >= least) chosen.push_back(std::move(windows[i]));
  }
  return chosen;
}

double image_speed(const std::vector<Window>& windows, const Parameters& parameters) {
  double squares = 0.0;
  int count = 0;
  for (const Window& window : windows) {
    for (const WindowPoint& point : window.points) {
      const auto term =
          pixel_error(window.motion, point.position, point.seen.front(), parameters, false);
      if (!term.valid) continue;
      squares += term.by_time.squaredNorm();
      ++count;
    }
  }
  return count > 0 ? std::sqrt(squares / count) : 0.0;
}

}  // namespace dkp_slam
