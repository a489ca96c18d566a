#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <thread>
#include <vector>

#include "dkp_slam/system/bounded_queue.h"

namespace dkp_slam {

/// Work on one frame after the other by several threads, and what follows it in the frames' order.
/// Used by one thread.
class OrderedWork {
 public:
  struct Task {
    std::function<void()> work;  ///< in some thread; may throw
    std::function<void()> done;  ///< in the caller's thread, when all before are done
    std::function<void()> undo;  ///< the same, where this or one before has failed; never throws
  };

  /// A thread per core.
  OrderedWork();
  /// Waits for what is under way, and undoes it.
  ~OrderedWork();
  OrderedWork(const OrderedWork&) = delete;
  OrderedWork& operator=(const OrderedWork&) = delete;

  static std::size_t cores();
  void add(Task task);
  /// Waits until no more than `left` are under way; of these it takes what is done by now. Throws
  /// what a task threw, when it and all after it are undone.
  void collect(std::size_t left);
  std::size_t under_way() const { return tasks_.size(); }

 private:
  struct Started {
    Task task;
    std::future<void> result;
  };
  void undo_all();

  std::deque<Started> tasks_;
  BoundedQueue<std::packaged_task<void()>> queue_;
  std::vector<std::thread> threads_;
};

}  // namespace dkp_slam
