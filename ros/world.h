#pragma once

#include <map>
#include <mutex>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/system/observer.h"

namespace dkp_slam::ros1 {

/// What observers were told of the map, for whoever asks. Each function may be called by any
/// thread.
class World : public SlamObserver {
 public:
  void on_map(const MapChange& change) override;

  /// Rises with every change of the map.
  long version() const;
  /// Keyframes of a map as they are known now, by time.
  Trajectory path(int map) const;
  /// Of all maps: metres, each in its map's world frame.
  std::vector<Eigen::Vector3f> landmarks(int map) const;

 private:
  struct Keyframe {
    int map = 0;
    double timestamp = 0.0;
    Se3 world_from_camera;
  };
  struct Landmark {
    Eigen::Vector3f position;
    int first_keyframe = -1;
  };

  mutable std::mutex mutex_;  // of what follows
  long version_ = 0;
  std::map<int, Keyframe> keyframes_;
  std::unordered_map<int, Landmark> landmarks_;
};

}  // namespace dkp_slam::ros1
