#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>

namespace dkp_slam {

/// A queue between two threads that holds a few items at most. Closing it from either side ends
/// both: `push` refuses, `pop` gives what is left and then nothing.
template <class T>
class BoundedQueue {
 public:
  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Waits for room; false when the queue was closed.
  bool push(T item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || items_.size() < capacity_; });
    if (closed_) return false;
    items_.push_back(std::move(item));
    changed_.notify_all();
    return true;
  }

  /// Never waits: when full, the oldest item goes. Returns how many went, 0 or 1.
  int push_newest(T item) {
    return push_newest(std::move(item), [](const T&) { return false; });
  }

  /// The same, and the oldest ones that are `overdue` (of an item) go, full or not. Returns how
  /// many went.
  template <class Overdue>
  int push_newest(T item, const Overdue& overdue) {
    const std::lock_guard lock(mutex_);
    int dropped = 0;
    while (!items_.empty() && (items_.size() >= capacity_ || overdue(items_.front()))) {
      items_.pop_front();
      ++dropped;
    }
    if (!closed_) items_.push_back(std::move(item));
    changed_.notify_all();
    return dropped;
  }

  /// Waits for an item; nothing once the queue is closed and empty.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || !items_.empty(); });
    return take();
  }

  /// Waits for an item until then, no longer.
  std::optional<T> pop_until(std::chrono::steady_clock::time_point then) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, then, [&] { return closed_ || !items_.empty(); });
    return take();
  }

  /// Drops what is in it.
  void clear() {
    const std::lock_guard lock(mutex_);
    items_.clear();
    changed_.notify_all();
  }

  bool closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  std::optional<T> take() {
    if (items_.empty()) return std::nullopt;
    T item = std::move(items_.front());
    items_.pop_front();
    changed_.notify_all();
    return item;
  }

  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> items_;
  bool closed_ = false;
};

}  // namespace dkp_slam
