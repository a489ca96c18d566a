#pragma once

#include <atomic>
#include <cassert>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "dkp_slam/thread_priority.h"
#include "dkp_slam/trace.h"

namespace dkp_slam {

/// A thread that solves one problem at a time. Problem and solution are values handed over under
/// one mutex; nothing else is shared. All functions belong to the thread that submits.
template <class Problem, class Solution>
class Worker {
 public:
  /// `solve` runs on the worker's thread. It should look at `stop` now and then and come back soon
  /// once that is set: what it then returns is dropped.
  using Solve = std::function<Solution(Problem problem, const std::atomic<bool>& stop)>;

  /// `name`, which must outlive the worker, is the thread's and that of its work in traces.
  /// `realtime`: nobody waits for the solution, and threads that are waited for go first.
  Worker(const char* name, Solve solve, bool realtime = false)
      : name_(name), realtime_(realtime), solve_(std::move(solve)), thread_([this] { work(); }) {}
  ~Worker() {
    abandon();
    {
      const std::lock_guard lock(mutex_);
      closing_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Starts on a problem, as soon as one that was abandoned has come to its end. Never waits; the
  /// last one's solution must have been taken or abandoned.
  void submit(Problem problem) {
    assert(!pending_);
    pending_ = true;
    stop_ = std::make_shared<std::atomic<bool>>(false);
    {
      const std::lock_guard lock(mutex_);
      job_.emplace(Job{std::move(problem), stop_});
    }
    changed_.notify_all();
  }
  /// True from `submit` until `take` or `abandon`.
  bool pending() const { return pending_; }
  /// True when `take` would not wait.
  bool finished() const {
    const std::lock_guard lock(mutex_);
    return solution_ || failure_;
  }
  /// Waits for the solution. Throws what solving threw; the next problem may be submitted all the
  /// same.
  Solution take() {
    assert(pending_);
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return solution_ || failure_; });
    pending_ = false;
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    Solution solution = std::move(*solution_);
    solution_.reset();
    return solution;
  }
  /// Drops what was submitted, solved or not, without waiting for anything.
  void abandon() {
    if (!pending_) return;
    const std::lock_guard lock(mutex_);
    *stop_ = true;
    job_.reset();
    solution_.reset();
    failure_ = nullptr;
    pending_ = false;
  }

 private:
  struct Job {
    Problem problem;
    std::shared_ptr<std::atomic<bool>> stop;
  };

  void work() {
    name_thread(name_);
    if (realtime_) lower_priority();
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return closing_ || job_; });
      if (closing_) return;
      const std::shared_ptr<std::atomic<bool>> stop = job_->stop;
      Problem problem = std::move(job_->problem);
      job_.reset();
      lock.unlock();
      std::optional<Solution> solution;
      std::exception_ptr failure;
      try {
        const TraceSpan span(name_);
        solution.emplace(solve_(std::move(problem), *stop));
      } catch (...) {
        failure = std::current_exception();
      }
      lock.lock();
      if (*stop) continue;
      solution_ = std::move(solution);
      failure_ = failure;
      changed_.notify_all();
    }
  }

  const char* name_;
  const bool realtime_;
  const Solve solve_;
  bool pending_ = false;                     // of the submitting thread alone
  std::shared_ptr<std::atomic<bool>> stop_;  // of the job submitted last
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Job> job_;
  std::optional<Solution> solution_;
  std::exception_ptr failure_;  // in its place
  bool closing_ = false;
  std::thread thread_;
};

}  // namespace dkp_slam
