#pragma once

#include <exception>
#include <mutex>
#include <utility>

namespace dkp_slam::apps {

/// Keeps what an observer's work failed with, for the thread that feeds: a run whose files cannot
/// be written is to end, though no observer can end it.
class ObserverFailure {
 public:
  /// Does the work, unless it has failed before.
  template <class Work>
  void guard(Work&& work) {
    {
      const std::lock_guard lock(mutex_);
      if (failure_) return;
    }
    try {
      std::forward<Work>(work)();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
    }
  }
  void rethrow() const {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  mutable std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace dkp_slam::apps
