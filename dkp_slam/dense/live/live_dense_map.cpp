#include "dkp_slam/dense/live/live_dense_map.h"

#include <sys/resource.h>

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/trace.h"

namespace dkp_slam {
namespace {

/// Seconds between frames of which a velocity is told.
constexpr double longest_step = 0.2;

LiveDenseOptions checked(LiveDenseOptions options, const Camera& camera) {
  if (options.keyframes < 2 || options.width < 1) {
    throw Error(
        fmt::format("dense map: {} keyframes of {} pixels' width; it takes 2 and 1 at least",
                    options.keyframes, options.width));
  }
  const KeyframeFusion checks_the_rest(kept_camera(camera, options.width), options.fusion);
  return options;
}

}  // namespace

LiveDenseMap::LiveDenseMap(const Camera& camera, const LiveDenseOptions& options)
    : camera_(kept_camera(camera, options.width)),
      options_(checked(options, camera)),
      wanted_(options.at_once),
      thread_([this] {
        name_thread("dense");
        // Of this thread alone: whoever tracks goes first.
        constexpr int low = 10;
        setpriority(PRIO_PROCESS, 0, low);
        work();
      }) {}

LiveDenseMap::~LiveDenseMap() {
  stop_ = true;
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

ObserverOptions LiveDenseMap::watching(double interval) {
  ObserverOptions options;
  options.delivery = Delivery::every;
  options.inbox = 64;
  options.map = true;
  options.map_interval = interval;
  return options;
}

Vector6d LiveDenseMap::velocity_of(const FrameSnapshot& snapshot) const {
  const FrameResult& now = snapshot.result;
  if (!last_ || !last_->localised || !now.localised || last_->map != now.map) {
    return Vector6d::Zero();
  }
  const double time = now.timestamp - last_->timestamp;
  if (!(time > 0.0) || time > longest_step) return Vector6d::Zero();
  return (last_->world_from_camera.inverse() * now.world_from_camera).log() / time;
}

void LiveDenseMap::on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) {
  if (snapshot->result.keyframe) {
    next_ = {snapshot->result.index,
             std::make_shared<const KeyframeImage>(keep_image(
                 snapshot->frame, snapshot->dynamics.mask, camera_, velocity_of(*snapshot)))};
  }
  last_ = snapshot->result;
}

void LiveDenseMap::on_keyframe(const KeyframeSnapshot& keyframe) {
  if (next_.first != keyframe.frame_index || !next_.second) return;  // live: the frame was left out
  const std::lock_guard lock(mutex_);
  images_[keyframe.id] = std::move(next_.second);
  const auto most = static_cast<std::size_t>(options_.keyframes);
  if (images_.size() <= most) return;
  auto image = std::next(images_.begin());  // the first stays
  for (std::size_t i = 0; i < most / 2; i += 2) image = std::next(images_.erase(image));
}

void LiveDenseMap::on_map(const MapChange& change) {
  std::unique_lock lock(mutex_);
  for (const KeyframeState& k : change.keyframes) {
    known_[k.id] = {k.map, k.camera_from_world.inverse()};
  }
  for (const int id : change.removed_keyframes) {
    known_.erase(id);
    images_.erase(id);
  }
  if (!wanted_) return;
  // Offline each change is fused by itself, so that it does not depend on who is faster.
  if (!options_.live) {
    changed_.wait(lock, [&] { return !pending_ || failure_ || closing_; });
  }
  ask();
}

void LiveDenseMap::ask() {
  pending_ = maps_now();
  changed_.notify_all();
}

LiveDenseMap::Maps LiveDenseMap::maps_now() const {
  Maps maps;
  for (const auto& [id, image] : images_) {
    const auto known = known_.find(id);
    if (known == known_.end()) continue;
    maps[known->second.map].push_back({id, known->second.world_from_camera, image});
  }
  return maps;
}

void LiveDenseMap::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return closing_ || pending_; });
    if (closing_) return;
    const Maps maps = std::move(*pending_);
    pending_.reset();
    busy_ = true;
    lock.unlock();
    changed_.notify_all();
    std::exception_ptr failure;
    try {
      const TraceSpan span("dense");
      fuse(maps);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    busy_ = false;
    if (failure) failure_ = failure;
    changed_.notify_all();
    if (failure) return;
  }
}

void LiveDenseMap::fuse(const Maps& maps) {
  const std::lock_guard lock(work_mutex_);
  std::erase_if(fusions_, [&](const auto& fusion) { return !maps.contains(fusion.first); });
  for (const auto& [map, keyframes] : maps) {
    std::unique_ptr<KeyframeFusion>& fusion = fusions_[map];
    if (!fusion) fusion = std::make_unique<KeyframeFusion>(camera_, options_.fusion);
    if (!fusion->update(keyframes, &stop_)) return;
  }
  ++version_;
}

void LiveDenseMap::rethrow_failure() const {
  if (failure_) std::rethrow_exception(failure_);
}

void LiveDenseMap::finish() {
  std::unique_lock lock(mutex_);
  if (!wanted_) {
    wanted_ = true;
    ask();
  }
  changed_.wait(lock, [&] { return (!pending_ && !busy_) || failure_ || closing_; });
  rethrow_failure();
}

bool LiveDenseMap::look(int map, const std::function<void(const KeyframeFusion&)>& use) {
  {
    const std::lock_guard lock(mutex_);
    rethrow_failure();
    if (!wanted_) {
      wanted_ = true;
      ask();
    }
  }
  const std::lock_guard lock(work_mutex_);
  const auto fusion = fusions_.find(map);
  if (fusion == fusions_.end() || stop_) return false;
  use(*fusion->second);
  return true;
}

int LiveDenseMap::largest_map() const {
  const std::lock_guard lock(mutex_);
  std::map<int, int> count;
  for (const auto& [id, image] : images_) {
    if (const auto known = known_.find(id); known != known_.end()) ++count[known->second.map];
  }
  int largest = 0;
  for (const auto& [map, keyframes] : count) {
    if (keyframes > count[largest]) largest = map;
  }
  return largest;
}

}  // namespace dkp_slam
