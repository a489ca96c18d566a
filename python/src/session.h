#pragma once

#include <atomic>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "dkp_slam/system/slam.h"
#include "python/src/arrays.h"
#include "python/src/arrivals.h"
#include "python/src/detectors.h"
#include "python/src/observers.h"

namespace dkp_slam::python {

/// dkp_slam.Result.
struct ResultObject {
  FrameResult result;
  std::shared_ptr<const FrameDetails> details;  ///< null where they were let go
};

/// dkp_slam.Slam: the door, for callers that hold the GIL and may be interrupted. Whatever waits
/// lets go of the GIL, and looks for Ctrl-C twenty times a second.
class Session {
 public:
  Session(const SlamConfig& config, std::unique_ptr<Detector> detector, std::optional<Map> stored,
          std::shared_ptr<DetectorFailure> failure);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Calls callables with what happens. Before the first frame, else throws ValueError.
  void observe(const Callbacks& callbacks, double map_interval);
  void add_observer(std::shared_ptr<SlamObserver> observer, const ObserverOptions& options);
  void feed(RgbdFrame frame);
  /// The next result, if there is one. Throws what ended the system early, after the results before
  /// it.
  std::optional<ResultObject> poll();
  /// Waits for it, `timeout` seconds at most; nothing when every frame has been answered.
  std::optional<ResultObject> wait(std::optional<double> timeout);
  void finish();
  /// Ends at once; nothing can be asked after it.
  void close();

  SlamCounters counters() const;
  const SlamConfig& config() const { return config_; }
  const std::string& detector_name() const { return detector_name_; }
  py::object detector_error() const;
  const std::optional<double>& last_timestamp() const { return last_timestamp_; }
  bool finished() const { return finished_; }
  /// After `finish`. Throws ValueError before and after `close`.
  std::shared_ptr<Slam> finished_slam() const;

  /// Closes all that are open: Python ends, and no thread may come to it any more.
  static void close_all();

 private:
  std::shared_ptr<Slam> slam() const;
  /// Throws ValueError in a callable of `observe`, where the system waits for the caller.
  void check_not_observing(const char* call) const;
  /// Waits, without the GIL, until `done`; false at the `timeout`. Throws KeyboardInterrupt and
  /// what else a signal handler throws.
  bool wait_until(const std::function<bool()>& done,
                  std::optional<double> timeout = std::nullopt) const;
  /// Takes over what results there are. Without the GIL.
  void collect(Slam& slam);
  bool idle(const Slam& slam) const;
  /// Whether the system has ended before its time. Without the GIL.
  bool failed();
  std::optional<ResultObject> take_result();

  const SlamConfig config_;
  const std::string detector_name_;
  const std::shared_ptr<DetectorFailure> detector_failure_;
  const std::shared_ptr<Arrivals> arrivals_ = std::make_shared<Arrivals>();
  std::vector<std::shared_ptr<CallableObserver>> observers_;
  std::shared_ptr<Slam> slam_;  // null once closed; changed with the GIL
  std::optional<double> last_timestamp_;
  bool finished_ = false;

  std::mutex mutex_;  // guards what follows; never held with the GIL wanted
  std::deque<FrameResult> results_;
  std::exception_ptr failure_;
};

}  // namespace dkp_slam::python
