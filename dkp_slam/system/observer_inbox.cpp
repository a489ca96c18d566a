#include "dkp_slam/system/observer_inbox.h"

#include <algorithm>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>

#include "dkp_slam/trace.h"

namespace dkp_slam {

ObserverInbox::ObserverInbox(std::shared_ptr<SlamObserver> observer, const ObserverOptions& options,
                             bool live)
    : observer_(std::move(observer)),
      options_(options),
      waits_(options.delivery == Delivery::every && !live),
      capacity_(options.delivery == Delivery::every ? std::max<std::size_t>(1, options.inbox) : 64),
      thread_([this] {
        name_thread("observer");
        work();
      }) {}

ObserverInbox::~ObserverInbox() {
  stop();
  if (thread_.joinable()) thread_.join();
}

void ObserverInbox::stop() {
  {
    const std::lock_guard lock(mutex_);
    items_.clear();
    closing_ = true;
  }
  changed_.notify_all();
}

void ObserverInbox::put_frame(std::shared_ptr<const FrameSnapshot> frame) {
  put_item({[frame = std::move(frame)](SlamObserver& o) { o.on_frame(frame); }, Kind::frame});
}

void ObserverInbox::put(Event event) { put_item({std::move(event), Kind::other}); }

void ObserverInbox::put_item(Item item) {
  std::unique_lock lock(mutex_);
  if (waits_) changed_.wait(lock, [&] { return closing_ || items_.size() < capacity_; });
  if (closing_) return;
  if (item.kind == Kind::frame && options_.delivery == Delivery::newest) drop_all(Kind::frame);
  if (items_.size() >= capacity_) {
    const auto oldest = [&](Kind kind) {
      return std::find_if(items_.begin(), items_.end(),
                          [kind](const Item& i) { return i.kind == kind; });
    };
    auto gone = oldest(Kind::frame);  // which is missed least
    if (gone == items_.end()) gone = oldest(Kind::other);
    if (gone != items_.end()) items_.erase(gone);
    ++dropped_;
  }
  items_.push_back(std::move(item));
  lock.unlock();
  changed_.notify_all();
}

void ObserverInbox::know(const Map& map) {
  if (options_.map) finder_.find(map);
}

bool ObserverInbox::map_is_due(double timestamp) const {
  if (waits_) return timestamp - map_timestamp_ >= options_.map_interval;
  return std::chrono::duration<double>(Clock::now() - map_sent_).count() >= options_.map_interval;
}

void ObserverInbox::put_map(const Map& map, double timestamp, bool now) {
  if (!options_.map || (!now && !map_is_due(timestamp))) return;
  {
    std::unique_lock lock(mutex_);
    if (now || waits_) changed_.wait(lock, [&] { return closing_ || !map_under_way_; });
    if (map_under_way_) return;
  }
  map_sent_ = Clock::now();
  map_timestamp_ = timestamp;
  auto change = std::make_shared<MapChange>(finder_.find(map));
  if (change->empty()) return;
  {
    // Beside the others' limit: a change that was left out would be missing for ever.
    const std::lock_guard lock(mutex_);
    map_under_way_ = true;
    items_.push_back({[this, change](SlamObserver& o) {
                        try {
                          o.on_map(*change);
                        } catch (...) {
                          map_done();
                          throw;
                        }
                        map_done();
                      },
                      Kind::map});
  }
  changed_.notify_all();
}

void ObserverInbox::map_done() {
  {
    const std::lock_guard lock(mutex_);
    map_under_way_ = false;
  }
  changed_.notify_all();
}

void ObserverInbox::drop_all(Kind kind) {
  dropped_ += static_cast<int>(
      std::erase_if(items_, [kind](const Item& item) { return item.kind == kind; }));
}

void ObserverInbox::finish() {
  {
    const std::lock_guard lock(mutex_);
    if (options_.delivery == Delivery::newest) drop_all(Kind::other);
    closing_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void ObserverInbox::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return closing_ || !items_.empty(); });
    if (items_.empty()) return;
    const Item item = std::move(items_.front());
    items_.pop_front();
    lock.unlock();
    changed_.notify_all();
    call(item.call);
    lock.lock();
  }
}

void ObserverInbox::call(const Event& event) {
  const char* reason = "an exception of unknown type";
  std::string text;
  const TraceSpan span("observer");
  try {
    event(*observer_);
    return;
  } catch (const std::exception& error) {
    text = error.what();
    reason = text.c_str();
  } catch (...) {
  }
  if (exceptions_++ == 0) spdlog::error("an observer failed: {}; going on", reason);
}

}  // namespace dkp_slam
