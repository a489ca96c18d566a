#include "viewer/scene_observer.h"

#include <fmt/format.h>

namespace dkp_slam::viewer {

void SceneObserver::on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) {
  scene_->add_frame(snapshot);
}

void SceneObserver::on_keyframe(const KeyframeSnapshot& keyframe) {
  scene_->add_keyframe(keyframe);
}

void SceneObserver::on_map(const MapChange& change) { scene_->apply(change); }

void SceneObserver::on_loop(const ClosedLoop& loop) {
  scene_->add_message(
      "info", fmt::format("loop closed: keyframe {} shows the place of {}, moved by {:.0f} mm",
                          loop.keyframe, loop.old_keyframe, 1e3 * loop.moved));
}

void SceneObserver::on_maps_merged(const ClosedLoop& loop) {
  scene_->add_message("info",
                      fmt::format("two maps merged: keyframe {} shows the place of {} ({} matches)",
                                  loop.keyframe, loop.old_keyframe, loop.matches));
}

void SceneObserver::on_lost(const TrackingChange& change) {
  scene_->add_message("warning", fmt::format("lost at frame {}", change.frame_index));
}

void SceneObserver::on_found(const TrackingChange& change) {
  scene_->add_message("info", fmt::format("found again at frame {}, after {:.1f} s",
                                          change.frame_index, change.lost_for));
}

}  // namespace dkp_slam::viewer
