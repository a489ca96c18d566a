#include "dkp_slam/calibration/window_system.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace dkp_slam {
namespace {

constexpr double loss_width = 2.385;  // standard deviations: 95% efficient on Gaussian noise

/// Cauchy's loss of a squared error over its variance, half of it, and the weight that goes with
/// it.
double loss(double squared) {
  constexpr double w2 = loss_width * loss_width;
  return 0.5 * w2 * std::log1p(squared / w2);
}
double loss_weight(double squared) { return 1.0 / (1.0 + squared / (loss_width * loss_width)); }

// Much weaker than what a single frame measures. The first holds the freedom to move everything at
// once, the second bridges frames that are missing.
constexpr double place_sigma = 1.0;   // radians, metres, from where a control began
constexpr double third_sigma = 0.02;  // radians, metres, of third differences of controls

}  // namespace

WindowSystem::WindowSystem(Window& window, const Camera& camera, bool lens)
    : window_(window), camera_(camera), lens_(lens), first_controls_(window.motion.controls) {}

double WindowSystem::inverse_sigma(const TimedSighting& seen) const {
  const double m = seen.depth.inverse;
  return camera_.depth_noise.sigma(1.0 / m) * m * m;
}

template <int Rows>
void WindowSystem::add(const ErrorTerm<Rows>& term, double sigma, std::size_t point) {
  if (!term.valid) return;
  const double information = 1.0 / (sigma * sigma);
  const double weight = information * loss_weight(information * term.error.squaredNorm());
  Eigen::Matrix<double, Rows, 24> by_motion;
  for (int i = 0; i < 4; ++i) {
    by_motion.template middleCols<6>(6 * i) =
        term.moment.weight[static_cast<std::size_t>(i)] * term.by_pose;
  }
  const int at = 6 * term.moment.first;
  const auto row = static_cast<Eigen::Index>(3 * point);
  const auto& x = term.by_point;
  const auto& t = term.by_parameter;
  h_.block<24, 24>(at, at).noalias() += weight * by_motion.transpose() * by_motion;
  g_.segment<24>(at).noalias() += weight * by_motion.transpose() * term.error;
  by_parameter_.middleRows<24>(at).noalias() += weight * by_motion.transpose() * t;
  reduced_.h.noalias() += weight * t.transpose() * t;
  reduced_.g.noalias() += weight * t.transpose() * term.error;
  points_.h[point].noalias() += weight * x.transpose() * x;
  points_.g.segment<3>(row).noalias() += weight * x.transpose() * term.error;
  points_.by_motion.block<3, 24>(row, at).noalias() += weight * x.transpose() * by_motion;
  points_.by_parameter.middleRows<3>(row).noalias() += weight * x.transpose() * t;
}

void WindowSystem::add_all(const Parameters& parameters, const MeasuredNoise& noise) {
  for (std::size_t i = 0; i < window_.points.size(); ++i) {
    const WindowPoint& point = window_.points[i];
    for (const TimedSighting& seen : point.seen) {
      add(pixel_error(window_.motion, point.position, seen, parameters, lens_),
          noise.pixel * seen.sigma, i);
      if (!seen.depth.known()) continue;
      add(depth_error(window_.motion, point.position, seen, parameters, lens_),
          noise.depth * inverse_sigma(seen), i);
    }
  }
}

void WindowSystem::add_priors() {
  const MotionSpline::Controls& c = window_.motion.controls;
  const MotionSpline::Controls away = c - first_controls_;
  constexpr double place = 1.0 / (place_sigma * place_sigma);
  constexpr double third = 1.0 / (third_sigma * third_sigma);
  h_.diagonal().array() += place;
  g_ += place * Eigen::Map<const Eigen::VectorXd>(away.data(), away.size());
  const Eigen::Vector4d d(-1.0, 3.0, -3.0, 1.0);
  for (int i = 0; i + 4 <= c.cols(); ++i) {
    const Vector6d error = c.middleCols<4>(i) * d;
    for (int a = 0; a < 4; ++a) {
      g_.segment<6>(6 * (i + a)) += third * d[a] * error;
      for (int b = 0; b < 4; ++b)
        h_.block<6, 6>(6 * (i + a), 6 * (i + b)).diagonal().array() += third * d[a] * d[b];
    }
  }
}

void WindowSystem::eliminate_points(double damping) {
  constexpr double least = 1e-6;  // 1/metre^2: a point that one ray saw has no depth
  // With h = L L^T of each point, L^-1 times its rows leaves plain products.
  Eigen::MatrixXd motion = points_.by_motion, parameter = points_.by_parameter;
  Eigen::VectorXd g = points_.g;
  for (std::size_t i = 0; i < points_.h.size(); ++i) {
    Eigen::Matrix3d& h = points_.h[i];
    h.diagonal().array() = h.diagonal().array() * (1.0 + damping) + least;
    const Eigen::LLT<Eigen::Matrix3d> factor(h);
    const auto row = static_cast<Eigen::Index>(3 * i);
    auto rows = motion.middleRows<3>(row);
    factor.matrixL().solveInPlace(rows);
    auto parameter_rows = parameter.middleRows<3>(row);
    factor.matrixL().solveInPlace(parameter_rows);
    auto g_rows = g.segment<3>(row);
    factor.matrixL().solveInPlace(g_rows);
  }
  h_.selfadjointView<Eigen::Lower>().rankUpdate(motion.transpose(), -1.0);
  g_.noalias() -= motion.transpose() * g;
  by_parameter_.noalias() -= motion.transpose() * parameter;
  reduced_.h.noalias() -= parameter.transpose() * parameter;
  reduced_.g.noalias() -= parameter.transpose() * g;
}

ReducedSystem WindowSystem::reduce(const Parameters& parameters, const MeasuredNoise& noise,
                                   double damping) {
  const Eigen::Index n = window_.motion.controls.size();
  const auto rows = static_cast<Eigen::Index>(3 * window_.points.size());
  h_ = Eigen::MatrixXd::Zero(n, n);
  g_ = Eigen::VectorXd::Zero(n);
  by_parameter_ = Eigen::MatrixXd::Zero(n, parameter_count);
  reduced_ = {};
  points_.h.assign(window_.points.size(), Eigen::Matrix3d::Zero());
  points_.g = Eigen::VectorXd::Zero(rows);
  points_.by_motion = Eigen::MatrixXd::Zero(rows, n);
  points_.by_parameter = Eigen::MatrixXd::Zero(rows, parameter_count);
  add_all(parameters, noise);
  add_priors();
  h_.diagonal().array() *= 1.0 + damping;
  eliminate_points(damping);
  factor_.compute(h_);
  const Eigen::MatrixXd solved = factor_.solve(by_parameter_);
  ReducedSystem out;
  out.h = reduced_.h - by_parameter_.transpose() * solved;
  out.g = reduced_.g - solved.transpose() * g_;
  out.cost = cost(parameters, noise);
  return out;
}

double WindowSystem::cost(const Parameters& parameters, const MeasuredNoise& noise) const {
  constexpr double far = 100.0;  // squared error of a point that is not before the camera
  double sum = 0.0;
  for (const WindowPoint& point : window_.points) {
    for (const TimedSighting& seen : point.seen) {
      const auto pixel = pixel_error(window_.motion, point.position, seen, parameters, false);
      const double s = noise.pixel * seen.sigma;
      sum += loss(pixel.valid ? pixel.error.squaredNorm() / (s * s) : far);
      if (!seen.depth.known()) continue;
      const auto depth = depth_error(window_.motion, point.position, seen, parameters, false);
      const double d = noise.depth * inverse_sigma(seen);
      sum += loss(depth.valid ? depth.error.squaredNorm() / (d * d) : far);
    }
  }
  return sum;
}

double WindowSystem::step(const Parameters& from, const Parameters& step,
                          const MeasuredNoise& noise) {
  old_controls_ = window_.motion.controls;
  old_points_.clear();
  const Eigen::VectorXd motion = -factor_.solve(g_ + by_parameter_ * step);
  window_.motion.controls +=
      Eigen::Map<const MotionSpline::Controls>(motion.data(), 6, old_controls_.cols());
  const Eigen::VectorXd points =
      points_.g + points_.by_motion * motion + points_.by_parameter * step;
  for (std::size_t i = 0; i < window_.points.size(); ++i) {
    old_points_.push_back(window_.points[i].position);
    window_.points[i].position -=
        points_.h[i].llt().solve(points.segment<3>(static_cast<Eigen::Index>(3 * i)));
  }
  return cost(from + step, noise);
}

void WindowSystem::undo() {
  window_.motion.controls = old_controls_;
  for (std::size_t i = 0; i < old_points_.size(); ++i) window_.points[i].position = old_points_[i];
}

void WindowSystem::errors(const Parameters& parameters, std::vector<double>& pixels,
                          std::vector<double>& depths) const {
  for (const WindowPoint& point : window_.points) {
    for (const TimedSighting& seen : point.seen) {
      const auto pixel = pixel_error(window_.motion, point.position, seen, parameters, false);
      if (pixel.valid) {
        pixels.push_back(pixel.error.x() / seen.sigma);
        pixels.push_back(pixel.error.y() / seen.sigma);
      }
      if (!seen.depth.known()) continue;
      const auto depth = depth_error(window_.motion, point.position, seen, parameters, false);
      if (depth.valid) depths.push_back(depth.error[0] / inverse_sigma(seen));
    }
  }
}

}  // namespace dkp_slam
