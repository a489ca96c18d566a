#include "dkp_slam/export/images/ordered_work.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

namespace dkp_slam {

std::size_t OrderedWork::cores() { return std::max(std::thread::hardware_concurrency(), 1U); }

OrderedWork::OrderedWork() : queue_(std::numeric_limits<std::size_t>::max()) {
  for (std::size_t i = 0; i < cores(); ++i) {
    threads_.emplace_back([this] {
      while (auto task = queue_.pop()) (*task)();
    });
  }
}

OrderedWork::~OrderedWork() {
  undo_all();
  queue_.close();
  for (std::thread& thread : threads_) thread.join();
}

void OrderedWork::add(Task task) {
  std::packaged_task<void()> work(std::move(task.work));
  tasks_.push_back({std::move(task), work.get_future()});
  queue_.push(std::move(work));
}

void OrderedWork::collect(std::size_t left) {
  constexpr auto at_once = std::chrono::seconds(0);
  while (!tasks_.empty() && (tasks_.size() > left || tasks_.front().result.wait_for(at_once) ==
                                                         std::future_status::ready)) {
    tasks_.front().result.wait();
    try {
      tasks_.front().result.get();
      tasks_.front().task.done();
    } catch (...) {
      tasks_.front().task.undo();
      tasks_.pop_front();
      undo_all();
      throw;
    }
    tasks_.pop_front();
  }
}

void OrderedWork::undo_all() {
  for (; !tasks_.empty(); tasks_.pop_front()) {
    tasks_.front().result.wait();
    tasks_.front().task.undo();
  }
}

}  // namespace dkp_slam
