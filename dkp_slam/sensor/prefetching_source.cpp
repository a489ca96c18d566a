#include "dkp_slam/sensor/prefetching_source.h"

#include <algorithm>
#include <utility>

namespace dkp_slam {

PrefetchingSource::PrefetchingSource(std::unique_ptr<RgbdSource> source, std::size_t capacity)
    : source_(std::move(source)),
      capacity_(std::max<std::size_t>(capacity, 1)),
      description_(source_->description()),
      size_(source_->size()),
      thread_([this] { read_ahead(); }) {}

PrefetchingSource::~PrefetchingSource() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::optional<RgbdFrame> PrefetchingSource::read() {
  Item item;
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !queue_.empty(); });
    if (queue_.front().frame) {
      item = std::move(queue_.front());
      queue_.pop_front();
    } else {
      item = queue_.front();  // the end and the error stay for later calls
    }
  }
  changed_.notify_all();
  skipped_ = item.skipped;
  if (item.error) std::rethrow_exception(item.error);
  return std::move(item.frame);
}

void PrefetchingSource::read_ahead() {
  for (bool more = true; more;) {
    Item item;
    try {
      item.frame = source_->read();
    } catch (...) {
      item.error = std::current_exception();
    }
    item.skipped = source_->skipped();
    more = item.frame.has_value();
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return stop_ || queue_.size() < capacity_; });
    if (stop_) return;
    queue_.push_back(std::move(item));
    lock.unlock();
    changed_.notify_all();
  }
}

}  // namespace dkp_slam
