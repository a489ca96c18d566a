#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>

#include "dkp_slam/map/map.h"
#include "dkp_slam/system/observer.h"

namespace dkp_slam {

/// One observer with its thread, and the events that wait for it.
///
/// Thread rule: events are put in by the tracking thread alone; `mutex_` guards the deque and the
/// flags, and is never held while the observer is called.
class ObserverInbox {
 public:
  /// `live`: nobody waits for the observer, whatever its delivery.
  ObserverInbox(std::shared_ptr<SlamObserver> observer, const ObserverOptions& options, bool live);
  /// Drops what waits; ends once the call under way does.
  ~ObserverInbox();
  ObserverInbox(const ObserverInbox&) = delete;
  ObserverInbox& operator=(const ObserverInbox&) = delete;

  /// Drops what waits, takes nothing more, and lets nobody wait.
  void stop();

  using Event = std::function<void(SlamObserver&)>;
  void put_frame(std::shared_ptr<const FrameSnapshot> frame);
  void put(Event event);
  /// Takes the map's present state as known: the first change starts from it.
  void know(const Map& map);
  /// Sends what changed in the map, where the observer asked for it, the interval has passed and it
  /// is done with the last change. An observer that the sender waits for gets it at fixed frames,
  /// however busy it is: the interval is then between their time stamps. `now` sends in any case.
  void put_map(const Map& map, double timestamp, bool now);
  /// Lets it have what waits (with Delivery::newest no more than the newest frame and the map's
  /// last change) and ends its thread.
  void finish();

  int exceptions() const { return exceptions_; }
  int dropped() const { return dropped_; }  ///< events left out

 private:
  enum class Kind { frame, map, other };
  struct Item {
    Event call;
    Kind kind;
  };
  using Clock = std::chrono::steady_clock;

  void put_item(Item item);
  void work();
  void call(const Event& event);
  void drop_all(Kind kind);  // with the mutex held
  bool map_is_due(double timestamp) const;
  void map_done();

  const std::shared_ptr<SlamObserver> observer_;
  const ObserverOptions options_;
  const bool waits_;  // the sender, for room
  const std::size_t capacity_;
  ChangeFinder finder_;  // the tracking thread's
  Clock::time_point map_sent_;
  double map_timestamp_ = -std::numeric_limits<double>::infinity();  // of the frame it was sent at
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  bool map_under_way_ = false;
  bool closing_ = false;
  std::atomic<int> exceptions_{0};
  std::atomic<int> dropped_{0};
  std::thread thread_;
};

}  // namespace dkp_slam
