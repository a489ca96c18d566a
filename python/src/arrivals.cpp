#include "python/src/arrivals.h"

#include <chrono>

namespace dkp_slam::python {

void Arrivals::on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) {
  auto details = std::make_shared<FrameDetails>();
  details->image = snapshot->frame.colour.size();
  details->mask = snapshot->dynamics.mask;
  details->keypoints = snapshot->keypoints;
  details->landmarks = snapshot->landmarks;
  details->is_static.reserve(snapshot->dynamics.features.size());
  for (const FeatureDynamics& f : snapshot->dynamics.features) {
    details->is_static.push_back(f.is_static ? 1 : 0);
  }
  details->objects = snapshot->dynamics.objects;
  details->detections = snapshot->detections;
  {
    const std::lock_guard lock(mutex_);
    newest_ = snapshot->result.index;
    details_[newest_] = std::move(details);
    if (details_.size() > most_kept) details_.erase(details_.begin());
  }
  changed_.notify_all();
}

std::shared_ptr<const FrameDetails> Arrivals::take(int frame_index) {
  const std::lock_guard lock(mutex_);
  const auto found = details_.find(frame_index);
  if (found == details_.end()) return nullptr;
  std::shared_ptr<const FrameDetails> details = std::move(found->second);
  details_.erase(found);
  return details;
}

int Arrivals::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

void Arrivals::wait_for_newer_than(int newest, double longest) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(longest), [&] { return newest_ > newest; });
}

}  // namespace dkp_slam::python
