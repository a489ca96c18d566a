#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "dkp_slam/optimization/bundle_adjustment.h"

namespace dkp_slam {

/// A thread that solves one bundle adjustment at a time. Problem and solution are values handed
/// over under one mutex; nothing else is shared.
class BundleWorker {
 public:
  BundleWorker(const Camera& camera, const MeasurementModel& model);
  ~BundleWorker();
  BundleWorker(const BundleWorker&) = delete;
  BundleWorker& operator=(const BundleWorker&) = delete;

  /// Starts on a problem. The last one's solution must have been taken.
  void submit(BundleProblem problem, const BundleOptions& options);
  /// True from `submit` until `take`.
  bool pending() const { return pending_; }
  /// True when `take` would not wait.
  bool finished() const;
  /// Waits for the solution.
  BundleSolution take();
  /// Stops the solver, which takes one of its iterations at most, and drops what it has.
  void cancel();

 private:
  void work();

  const Camera camera_;
  const MeasurementModel model_;
  bool pending_ = false;  // of the submitting thread alone
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<std::pair<BundleProblem, BundleOptions>> problem_;
  std::optional<BundleSolution> solution_;
  bool closing_ = false;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace dkp_slam
