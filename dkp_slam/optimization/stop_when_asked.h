#pragma once

#include <atomic>

#include <ceres/iteration_callback.h>

namespace dkp_slam {

/// Ends a Ceres run when somebody sets the flag; null is never set.
class StopWhenAsked final : public ceres::IterationCallback {
 public:
  explicit StopWhenAsked(const std::atomic<bool>* stop) : stop_(stop) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return stop_ && *stop_ ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::atomic<bool>* stop_;
};

}  // namespace dkp_slam
