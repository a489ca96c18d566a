#pragma once

#include <memory>

#include "dkp_slam/system/observer.h"
#include "viewer/scene.h"

namespace dkp_slam::viewer {

/// Takes what happens in a run into a scene. For Delivery::newest, with changes of the map.
class SceneObserver : public SlamObserver {
 public:
  explicit SceneObserver(std::shared_ptr<Scene> scene) : scene_(std::move(scene)) {}

  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override;
  void on_keyframe(const KeyframeSnapshot& keyframe) override;
  void on_map(const MapChange& change) override;
  void on_loop(const ClosedLoop& loop) override;
  void on_maps_merged(const ClosedLoop& loop) override;
  void on_lost(const TrackingChange& change) override;
  void on_found(const TrackingChange& change) override;

 private:
  const std::shared_ptr<Scene> scene_;
};

}  // namespace dkp_slam::viewer
