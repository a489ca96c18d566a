#include "dkp_slam/calibration/adjustment.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <opencv2/core/utility.hpp>

#include "dkp_slam/calibration/window_system.h"

namespace dkp_slam {
namespace {

constexpr int rounds = 3;  // with the noise that the one before found
constexpr int iterations = 12;
constexpr double first_damping = 1e-7, most_damping = 1e3;
constexpr double enough = 1e-8;  // of the cost, relative

/// Standard deviation by the median of what is mostly Gaussian.
double robust_deviation(std::vector<double>& errors, double otherwise, double least) {
  if (errors.size() < 10) return otherwise;
  for (double& e : errors) e = std::abs(e);
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return std::max(1.4826 * *middle, least);
}

/// All windows together.
class Systems {
 public:
  Systems(std::vector<Window>& windows, const Camera& camera, const ParameterChoice& free)
      : free_(free) {
    const bool lens =
        std::any_of(free.begin() + first_lens_parameter, free.end(), [](bool f) { return f; });
    for (Window& window : windows)
      systems_.push_back(std::make_unique<WindowSystem>(window, camera, lens));
  }

  /// Work on each window, on all cores.
  template <class Result, class Work>
  std::vector<Result> each(const Work& work) const {
    std::vector<Result> results(systems_.size());
    cv::parallel_for_({0, static_cast<int>(systems_.size())}, [&](const cv::Range& range) {
      for (int i = range.start; i < range.end; ++i) {
        const auto k = static_cast<std::size_t>(i);
        results[k] = work(*systems_[k]);
      }
    });
    return results;
  }

  std::vector<ReducedSystem> reduce(const Parameters& p, const MeasuredNoise& noise,
                                    double damping) const {
    auto all = each<ReducedSystem>([&](WindowSystem& s) { return s.reduce(p, noise, damping); });
    for (ReducedSystem& r : all) {
      for (int i = 0; i < parameter_count; ++i) {
        if (free_[static_cast<std::size_t>(i)]) continue;
        r.h.row(i).setZero();
        r.h.col(i).setZero();
        r.g[i] = 0.0;
      }
    }
    return all;
  }

  double try_step(const Parameters& p, const Parameters& step, const MeasuredNoise& noise) const {
    double sum = 0.0;
    for (double c : each<double>([&](WindowSystem& s) { return s.step(p, step, noise); })) sum += c;
    return sum;
  }
  void undo() const {
    for (const auto& s : systems_) s->undo();
  }

  MeasuredNoise noise(const Parameters& p, const MeasuredNoise& before, Adjustment& out) const {
    std::vector<double> pixels, depths;
    for (const auto& s : systems_) s->errors(p, pixels, depths);
    out.sightings = static_cast<int>(pixels.size() / 2);
    out.depths = static_cast<int>(depths.size());
    // Images without any noise are no measurements without any.
    constexpr double least_pixel = 0.05, least_depth = 0.02;
    return {robust_deviation(pixels, before.pixel, least_pixel),
            robust_deviation(depths, before.depth, least_depth)};
  }

  /// Inverse over the free parameters, zero elsewhere. Scaled: units differ by powers of ten.
  ParameterMatrix inverse(const ParameterMatrix& h) const {
    Parameters scale = Parameters::Zero();
    ParameterMatrix scaled = ParameterMatrix::Identity();
    for (int i = 0; i < parameter_count; ++i) {
      if (free_[static_cast<std::size_t>(i)]) scale[i] = 1.0 / std::sqrt(std::max(h(i, i), 1e-30));
    }
    for (int i = 0; i < parameter_count; ++i) {
      for (int j = 0; j < parameter_count; ++j) {
        if (scale[i] > 0.0 && scale[j] > 0.0) scaled(i, j) = scale[i] * h(i, j) * scale[j];
      }
    }
    return scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  }

 private:
  ParameterChoice free_;
  std::vector<std::unique_ptr<WindowSystem>> systems_;
};

ReducedSystem sum_of(const std::vector<ReducedSystem>& all) {
  ReducedSystem sum;
  for (const ReducedSystem& r : all) {
    sum.h += r.h;
    sum.g += r.g;
    sum.cost += r.cost;
  }
  return sum;
}

/// Returns whether it came to an end.
bool minimise(const Systems& systems, const MeasuredNoise& noise, Parameters& p) {
  double damping = first_damping;
  for (int i = 0; i < iterations; ++i) {
    const ReducedSystem sum = sum_of(systems.reduce(p, noise, damping));
    ParameterMatrix h = sum.h;
    h.diagonal() *= 1.0 + damping;
    const Parameters step = -(systems.inverse(h) * sum.g);
    const double cost = step.allFinite() ? systems.try_step(p, step, noise) : INFINITY;
    if (!(cost < sum.cost)) {
      systems.undo();
      damping *= 30.0;
      if (damping > most_damping || std::abs(cost - sum.cost) < enough * sum.cost) return true;
      continue;
    }
    p += step;
    damping = std::max(damping / 10.0, 1e-9);
    if (sum.cost - cost < enough * sum.cost) return true;
  }
  return false;
}

ParameterMatrix covariance_of(const Systems& systems, const MeasuredNoise& noise,
                              const Parameters& p) {
  const std::vector<ReducedSystem> all = systems.reduce(p, noise, 0.0);
  const ReducedSystem sum = sum_of(all);
  const ParameterMatrix plain = systems.inverse(sum.h);
  constexpr std::size_t least = 4;  // windows whose scatter says anything
  // Errors within a window hang together: without a scatter to see by how much, by a guess.
  constexpr double guess = 3.0;
  if (all.size() < least) return guess * guess * plain;
  // By how much the result would change without each of the windows. What a window wants at the
  // common result says too little: one that tells the most has pulled the result to itself.
  ParameterMatrix scatter = ParameterMatrix::Zero();
  for (const ReducedSystem& r : all) {
    const Parameters change = systems.inverse(sum.h - r.h) * (sum.g - r.g);
    scatter += change * change.transpose();
  }
  const auto n = static_cast<double>(all.size());
  ParameterMatrix covariance = scatter * (n - 1.0) / n;
  for (int i = 0; i < parameter_count; ++i)
    covariance(i, i) = std::max(covariance(i, i), plain(i, i));
  return covariance;
}

}  // namespace

Adjustment adjust_windows(std::vector<Window>& windows, const Camera& camera,
                          const Parameters& start, const ParameterChoice& free) {
  Adjustment result;
  result.parameters = start;
  const Systems systems(windows, camera, free);
  for (int i = 0; i < rounds; ++i) {
    result.converged = minimise(systems, result.noise, result.parameters);
    result.noise = systems.noise(result.parameters, result.noise, result);
  }
  result.covariance = covariance_of(systems, result.noise, result.parameters);
  return result;
}

}  // namespace dkp_slam
