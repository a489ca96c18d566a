#include "viewer/truth.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/absolute_error.h"
#include "viewer/container.h"

namespace dkp_slam::viewer {
namespace {

using Clock = std::chrono::steady_clock;

/// From one that is told to the next, so that there are at most so many.
std::size_t step_for(std::size_t count) {
  return (count + TruthComparison::most_points - 1) / TruthComparison::most_points;
}

}  // namespace

std::shared_ptr<const std::string> TruthComparison::report(
    const std::function<Trajectory()>& estimate) {
  constexpr auto least_wait = std::chrono::milliseconds(500);
  constexpr int share = 20;  // of the time that is spent on it, one part
  const std::lock_guard lock(mutex_);
  const Clock::time_point start = Clock::now();
  if (last_ && start < next_) return last_;
  last_ = std::make_shared<const std::string>(compute(estimate()));
  const Clock::time_point end = Clock::now();
  next_ = end + std::max<Clock::duration>(least_wait, share * (end - start));
  return last_;
}

std::string TruthComparison::compute(const Trajectory& estimate) const {
  nlohmann::json head = {{"matches", 0}};
  Container container;
  std::vector<double> times;
  std::vector<float> errors, path;
  try {
    const AbsoluteError found = absolute_error(truth_, estimate);
    const Se3 estimate_from_truth = found.truth_from_estimate.inverse();
    head = {{"matches", found.matches.size()},
            {"rmse", found.statistics.rmse},
            {"median", found.statistics.median},
            {"max", found.statistics.max}};
    const std::size_t step = std::max<std::size_t>(1, step_for(found.matches.size()));
    for (std::size_t i = 0; i < found.matches.size(); i += step) {
      times.push_back(estimate[found.matches[i].estimate].timestamp);
      errors.push_back(static_cast<float>(found.errors[i]));
    }
    // What lies before and after the estimate would only make the picture small.
    const double first = estimate.front().timestamp, last = estimate.back().timestamp;
    const std::size_t truth_step = std::max<std::size_t>(1, step_for(truth_.size()));
    for (std::size_t i = 0; i < truth_.size(); i += truth_step) {
      if (truth_[i].timestamp < first || truth_[i].timestamp > last) continue;
      const Eigen::Vector3d at = estimate_from_truth * truth_[i].world_from_camera.translation;
      for (int c = 0; c < 3; ++c) path.push_back(static_cast<float>(at[c]));
    }
  } catch (const Error&) {
    // Nothing to compare yet, which `matches` says.
  }
  container.add("times", times);
  container.add("errors", errors);
  container.add("truth", path);
  return container.finish(std::move(head));
}

}  // namespace dkp_slam::viewer
