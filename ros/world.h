#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/system/observer.h"

namespace dkp_slam::ros1 {

/// What observers were told of the map, and images of its keyframes, for whoever asks. Each
/// function may be called by any thread.
class World : public SlamObserver {
 public:
  /// Of at most `keyframes` images are kept, at half the camera's size.
  World(const Camera& camera, int keyframes);

  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override;
  void on_map(const MapChange& change) override;

  /// Rises with every change of the map.
  long version() const;
  /// Keyframes of a map as they are known now, by time.
  Trajectory path(int map) const;
  /// Of all maps: metres, each in its map's world frame.
  std::vector<Eigen::Vector3f> landmarks(int map) const;

  struct PosedFrame {
    RgbdFrame frame;  ///< with its mask; of the size of `small_camera`
    Se3 world_from_camera;
  };
  /// Keyframes of a map whose images are there.
  std::vector<PosedFrame> frames(int map) const;
  const Camera& small_camera() const { return small_; }

 private:
  struct Keyframe {
    int map = 0, frame_index = -1;
    double timestamp = 0.0;
    Se3 world_from_camera;
  };
  struct Landmark {
    Eigen::Vector3f position;
    int first_keyframe = -1;
  };

  const Camera small_;
  const std::size_t most_images_;
  mutable std::mutex mutex_;  // of what follows
  long version_ = 0;
  std::map<int, Keyframe> keyframes_;
  std::unordered_map<int, Landmark> landmarks_;
  std::map<int, RgbdFrame> images_;  // by frame index
};

}  // namespace dkp_slam::ros1
