#include "dkp_slam/evaluation/relative_error.h"

#include <cmath>
#include <optional>
#include <random>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/association.h"

namespace dkp_slam {
namespace {

using IndexPair = std::pair<std::size_t, std::size_t>;

/// Uniform in [0, bound). Written out because the standard's distributions differ by library, and
/// the same seed must give the same figures everywhere; the bias is below bound / 2^64.
std::size_t draw(std::mt19937_64& random, std::size_t bound) { return random() % bound; }

/// How far along the estimate each pose is, in the unit of the step; ascending.
std::vector<double> progress(std::span<const StampedPose> poses, StepUnit unit) {
  if (unit == StepUnit::seconds) return stamps_of(poses);
  std::vector<double> along(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Se3 motion = poses[i].world_from_camera.inverse() * poses[i - 1].world_from_camera;
    double step = 1.0;
    if (unit == StepUnit::metres) step = motion.translation.norm();
    if (unit == StepUnit::radians) step = motion.angle();
    if (unit == StepUnit::degrees) step = motion.angle() * 180.0 / M_PI;
    along[i] = along[i - 1] + step;
  }
  return along;
}

std::vector<IndexPair> every_pair(std::size_t poses, const RelativeErrorOptions& options) {
  std::vector<IndexPair> pairs;
  if (options.max_pairs == 0 || poses * poses < options.max_pairs) {
    for (std::size_t i = 0; i < poses; ++i) {
      for (std::size_t j = 0; j < poses; ++j) pairs.emplace_back(i, j);
    }
    return pairs;
  }
  std::mt19937_64 random(options.seed);
  for (std::size_t k = 0; k < options.max_pairs; ++k) {
    const std::size_t i = draw(random, poses);
    pairs.emplace_back(i, draw(random, poses));
  }
  return pairs;
}

std::vector<IndexPair> pairs_over_step(std::span<const StampedPose> estimate,
                                       const RelativeErrorOptions& options) {
  const std::vector<double> along = progress(estimate, options.unit);
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < along.size(); ++i) {
    const std::size_t j = nearest_index(along, along[i] + options.delta);
    // The last pose is the nearest to every step that leads past the end.
    if (j + 1 != along.size()) pairs.emplace_back(i, j);
  }
  if (options.max_pairs == 0 || pairs.size() <= options.max_pairs) return pairs;
  std::mt19937_64 random(options.seed);
  for (std::size_t k = 0; k < options.max_pairs; ++k) {
    std::swap(pairs[k], pairs[k + draw(random, pairs.size() - k)]);
  }
  pairs.resize(options.max_pairs);
  return pairs;
}

/// For each pose of the estimate the index of the true pose of its moment, if there is one.
std::vector<std::optional<std::size_t>> true_poses(std::span<const StampedPose> truth,
                                                   std::span<const StampedPose> estimate,
                                                   double offset) {
  const std::vector<double> stamps = stamps_of(truth);
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) intervals.push_back(stamps[i] - stamps[i - 1]);
  const double max_difference = 2.0 * median(intervals);
  std::vector<std::optional<std::size_t>> found(estimate.size());
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const double stamp = estimate[i].timestamp + offset;
    const std::size_t nearest = nearest_index(stamps, stamp);
    if (std::abs(stamps[nearest] - stamp) <= max_difference) found[i] = nearest;
  }
  return found;
}

}  // namespace

std::string short_name(StepUnit unit) {
  switch (unit) {
    case StepUnit::seconds:
      return "s";
    case StepUnit::frames:
      return "f";
    case StepUnit::metres:
      return "m";
    case StepUnit::radians:
      return "rad";
    case StepUnit::degrees:
      return "deg";
  }
  return "";
}

RelativeError relative_error(std::span<const StampedPose> truth,
                             std::span<const StampedPose> estimate,
                             const RelativeErrorOptions& options) {
  if (!std::isfinite(options.delta) || options.delta == 0.0) {
    throw Error(
        fmt::format("relative error over a step of {}; give a step that is not 0", options.delta));
  }
  if (truth.size() < 2 || estimate.size() < 2) {
    throw Error(
        fmt::format("relative error needs 2 poses or more: ground truth has {}, trajectory "
                    "has {}; give longer trajectories",
                    truth.size(), estimate.size()));
  }
  const auto true_index = true_poses(truth, estimate, options.offset);
  RelativeError result;
  std::vector<double> translations;
  std::vector<double> rotations;
  for (const auto& [i, j] : options.all_pairs ? every_pair(estimate.size(), options)
                                              : pairs_over_step(estimate, options)) {
    if (!true_index[i] || !true_index[j]) continue;
    const Se3 estimated = estimate[j].world_from_camera.inverse() * estimate[i].world_from_camera;
    const Se3 actual =
        truth[*true_index[j]].world_from_camera.inverse() * truth[*true_index[i]].world_from_camera;
    const Se3 error = estimated.inverse() * actual;
    translations.push_back(error.translation.norm());
    rotations.push_back(error.angle());
    result.samples.push_back(
        {estimate[i].timestamp, estimate[j].timestamp, translations.back(), rotations.back()});
  }
  if (result.samples.size() < 2) {
    throw Error(fmt::format(
        "{} pose pairs {} {} apart have ground truth, at least 2 needed; choose a shorter step, or "
        "give the difference of the clocks with --offset",
        result.samples.size(), options.delta, short_name(options.unit)));
  }
  result.translation = summarise(translations);
  result.rotation = summarise(rotations);
  return result;
}

}  // namespace dkp_slam
