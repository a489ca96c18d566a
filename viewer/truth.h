#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam::viewer {

/// How far the path is from the true one, over time. Computed when somebody asks, a twentieth of
/// the time at most.
class TruthComparison {
 public:
  /// `truth`: in the order of its stamps; may be empty.
  explicit TruthComparison(Trajectory truth) : truth_(std::move(truth)) {}

  bool known() const { return truth_.size() >= 2; }
  /// A Container: matches, rmse, median, max (metres),
  /// where anything could be compared; sections times (float64, seconds) and errors (float32,
  /// metres), at most `most_points`, and truth (3 float32 each, in the world frame of the path).
  std::shared_ptr<const std::string> report(const std::function<Trajectory()>& estimate);

  static constexpr std::size_t most_points = 3000;

 private:
  std::string compute(const Trajectory& estimate) const;

  const Trajectory truth_;
  std::mutex mutex_;
  std::shared_ptr<const std::string> last_;
  std::chrono::steady_clock::time_point next_;  // not before then
};

}  // namespace dkp_slam::viewer
