#include "python/src/session.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/system/frame_pipeline.h"
#include "python/src/mailbox.h"

namespace dkp_slam::python {
namespace {

using Clock = std::chrono::steady_clock;

/// Frames under way that leave the system room for one more, so that `Slam::feed` never waits for a
/// detector: that may be Python's, and waits for whoever feeds to let go of the GIL.
constexpr int most_under_way = room_before_answer - 1;
constexpr std::size_t most_results = 18000;  // as the system keeps

/// All that are open. Touched with the GIL only.
std::set<Session*>& open_sessions() {
  static auto* const sessions = new std::set<Session*>;
  return *sessions;
}

/// To end a Slam is to wait for its threads, of which one may be in a detector of Python's.
void end_without_gil(Slam* slam) {
  if (PyGILState_Check() == 0) {
    delete slam;
    return;
  }
  const py::gil_scoped_release release;
  delete slam;
}

}  // namespace

Session::Session(const SlamConfig& config, std::unique_ptr<Detector> detector,
                 std::optional<Map> stored, std::shared_ptr<DetectorFailure> failure)
    : config_(config),
      detector_name_(detector ? detector->name() : "none"),
      detector_failure_(std::move(failure)) {
  {
    const py::gil_scoped_release release;
    slam_ = {new Slam(config, std::move(detector), std::move(stored)), end_without_gil};
    slam_->add_observer(arrivals_, {Delivery::every, Arrivals::most_kept});
  }
  open_sessions().insert(this);
}

Session::~Session() {
  open_sessions().erase(this);
  slam_ = nullptr;
  deliver();
}

void Session::close() {
  check_not_observing("close");
  open_sessions().erase(this);
  slam_ = nullptr;
  deliver();
}

void Session::close_all() {
  const std::vector<Session*> sessions(open_sessions().begin(), open_sessions().end());
  for (Session* session : sessions) session->close();
}

std::shared_ptr<Slam> Session::slam() const {
  if (!slam_) value_error("this Slam is closed; make another");
  return slam_;
}

void Session::check_not_observing(const char* call) const {
  if (!CallableObserver::calling()) return;
  value_error(
      fmt::format("{}() waits for the system, which waits for this callable to end; call it from "
                  "elsewhere",
                  call));
}

void Session::observe(const Callbacks& callbacks, double map_interval) {
  auto observer = std::make_shared<CallableObserver>(callbacks);
  ObserverOptions options;
  options.delivery = Delivery::every;
  options.inbox = 64;
  options.map = observer->wants_map();
  options.map_interval = map_interval;
  add_observer(observer, options);
  observers_.push_back(std::move(observer));
}

void Session::add_observer(std::shared_ptr<SlamObserver> observer, const ObserverOptions& options) {
  const std::shared_ptr<Slam> slam = this->slam();
  if (last_timestamp_ || finished_) {
    value_error("who is to be told of a run must be added before its first frame");
  }
  const py::gil_scoped_release release;
  slam->add_observer(std::move(observer), options);
}

bool Session::wait_until(const std::function<bool()>& done, std::optional<double> timeout) const {
  constexpr double longest = 0.05;  // seconds without a look at the signals
  const auto start = Clock::now();
  const auto left = [&] {
    return timeout ? *timeout - std::chrono::duration<double>(Clock::now() - start).count()
                   : longest;
  };
  while (true) {
    bool fulfilled = false;
    {
      const py::gil_scoped_release release;
      const int newest = arrivals_->newest();
      fulfilled = done();
      if (!fulfilled) {
        if (left() <= 0.0) return false;
        arrivals_->wait_for_newer_than(newest, std::min(left(), longest));
      }
    }
    deliver();
    if (fulfilled) return true;
    if (Py_MakePendingCalls() != 0) throw py::error_already_set();
  }
}

void Session::collect(Slam& slam) {
  const std::lock_guard lock(mutex_);
  if (failure_) return;
  try {
    while (std::optional<FrameResult> result = slam.poll()) {
      results_.push_back(*result);
      if (results_.size() > most_results) results_.pop_front();
    }
  } catch (...) {
    failure_ = std::current_exception();
  }
}

bool Session::idle(const Slam& slam) const {
  const SlamCounters counters = slam.counters();
  return counters.answered + counters.dropped >= counters.fed;
}

bool Session::failed() {
  const std::lock_guard lock(mutex_);
  return failure_ != nullptr;
}

void Session::feed(RgbdFrame frame) {
  check_not_observing("feed");
  const std::shared_ptr<Slam> slam = this->slam();
  const double timestamp = frame.timestamp;
  if (!config_.realtime) {
    wait_until([&] {
      collect(*slam);
      const SlamCounters counters = slam->counters();
      return counters.fed - counters.answered <= most_under_way || failed();
    });
  }
  {
    const py::gil_scoped_release release;
    slam->feed(std::move(frame));
  }
  last_timestamp_ = timestamp;
  deliver();
}

std::optional<ResultObject> Session::take_result() {
  std::optional<ResultObject> taken;
  {
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    if (!results_.empty()) {
      taken.emplace(ResultObject{results_.front(), nullptr});
      results_.pop_front();
    } else if (failure_) {
      std::rethrow_exception(failure_);
    }
  }
  if (!taken) return taken;
  // They come right after the result; live, hardly ever, they are left out.
  const int index = taken->result.index;
  wait_until([&] { return arrivals_->newest() >= index; }, 1.0);
  taken->details = arrivals_->take(index);
  return taken;
}

std::optional<ResultObject> Session::poll() {
  const std::shared_ptr<Slam> slam = this->slam();
  {
    const py::gil_scoped_release release;
    collect(*slam);
  }
  deliver();
  return take_result();
}

std::optional<ResultObject> Session::wait(std::optional<double> timeout) {
  check_not_observing("wait");
  const std::shared_ptr<Slam> slam = this->slam();
  wait_until(
      [&] {
        const bool none_under_way = idle(*slam);
        collect(*slam);
        const std::lock_guard lock(mutex_);
        return none_under_way || !results_.empty() || failure_;
      },
      timeout);
  return take_result();
}

void Session::finish() {
  check_not_observing("finish");
  const std::shared_ptr<Slam> slam = this->slam();
  if (finished_) return;
  // Interrupted here, nothing has been ended, and it may go on.
  wait_until([&] {
    collect(*slam);
    return idle(*slam) || failed();
  });
  // Interrupted here, the last adjustment is left out.
  std::atomic<bool> stop{false}, done{false};
  std::exception_ptr problem;
  std::thread finisher([&] {
    try {
      slam->finish(&stop);
    } catch (...) {
      problem = std::current_exception();
    }
    done = true;
  });
  std::exception_ptr interruption;
  try {
    wait_until([&] { return done.load(); });
  } catch (...) {
    interruption = std::current_exception();
  }
  {
    const py::gil_scoped_release release;
    stop = true;
    finisher.join();
    collect(*slam);
  }
  finished_ = true;
  for (const auto& observer : observers_) observer->let_go();
  deliver();
  if (interruption) std::rethrow_exception(interruption);
  if (problem) std::rethrow_exception(problem);
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

SlamCounters Session::counters() const {
  const std::shared_ptr<Slam> slam = this->slam();
  const py::gil_scoped_release release;
  return slam->counters();
}

py::object Session::detector_error() const {
  if (detector_failure_->exception == nullptr) return py::none();
  return py::reinterpret_borrow<py::object>(detector_failure_->exception);
}

std::shared_ptr<Slam> Session::finished_slam() const {
  std::shared_ptr<Slam> slam = this->slam();
  if (!finished_) value_error("the map and the trajectories are there after finish()");
  return slam;
}

}  // namespace dkp_slam::python
