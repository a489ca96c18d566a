#include "dkp_slam/mapping/bundle_worker.h"

#include <cassert>

namespace dkp_slam {

BundleWorker::BundleWorker(const Camera& camera, const MeasurementModel& model)
    : camera_(camera), model_(model), thread_([this] { work(); }) {}

BundleWorker::~BundleWorker() {
  stop_ = true;
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void BundleWorker::submit(BundleProblem problem, const BundleOptions& options) {
  assert(!pending_);
  pending_ = true;
  {
    const std::lock_guard lock(mutex_);
    problem_.emplace(std::move(problem), options);
  }
  changed_.notify_all();
}

bool BundleWorker::finished() const {
  const std::lock_guard lock(mutex_);
  return solution_.has_value();
}

BundleSolution BundleWorker::take() {
  assert(pending_);
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return solution_.has_value(); });
  BundleSolution solution = std::move(*solution_);
  solution_.reset();
  pending_ = false;
  return solution;
}

void BundleWorker::cancel() {
  stop_ = true;
  take();
  stop_ = false;
}

void BundleWorker::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return closing_ || problem_; });
    if (closing_) return;
    const auto [problem, options] = std::move(*problem_);
    problem_.reset();
    lock.unlock();
    BundleSolution solution = adjust_bundle(camera_, model_, problem, options, &stop_);
    lock.lock();
    solution_ = std::move(solution);
    changed_.notify_all();
  }
}

}  // namespace dkp_slam
