#pragma once

#include <exception>
#include <mutex>
#include <utility>

#include "dkp_slam/system/observer.h"

namespace dkp_slam {

/// An observer that writes files which the run needs: what its work failed with is kept for the
/// thread that feeds. A run whose files cannot be written is to end, though no observer can end it.
class FileObserver : public SlamObserver {
 public:
  /// Throws what kept something from being written, if anything did. For any thread.
  void rethrow_failure() const {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
  }

 protected:
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

 private:
  mutable std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace dkp_slam
