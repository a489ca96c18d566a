#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "dkp_slam/dense/dense_map.h"
#include "dkp_slam/dense/free_space.h"
#include "dkp_slam/dense/keyframe_image.h"
#include "dkp_slam/geometry/stamped_pose.h"

namespace dkp_slam {

struct KeyframeFusionOptions {
  DenseMapOptions map;
  DepthViewOptions view;
  double cell = 0.05;  ///< metres, of free space; 0: none is kept
  /// Voxels that what a keyframe sees, at half the range, may lie beside where it was fused. What
  /// has moved farther is fused again; at 0 whatever moved.
  double moved = 0.5;
};

/// A keyframe as it is known now.
struct PosedImage {
  int id = -1;
  Se3 world_from_camera;
  std::shared_ptr<const KeyframeImage> image;
};

/// The dense map of one map's keyframes, which follows them: keyframes come, go and move, and what
/// they saw does, too. At any time the map holds what fusing all of them at their poses at once
/// would give (with `moved` 0 to the bit, else to that much), whatever they did before.
///
/// Carving forgets, so that a keyframe cannot be taken out of a voxel again. The blocks that it saw
/// are cleared instead and fused anew from all keyframes that see them; where more than a quarter
/// of the keyframes have moved, all blocks are.
class KeyframeFusion {
 public:
  /// `camera`: of the kept images. Throws `Error` for options that make no sense.
  KeyframeFusion(const Camera& camera, const KeyframeFusionOptions& options);

  /// Brings the map to these keyframes, ascending by id. By one thread, the calling one. False when
  /// `stop` was set before it was done; the map is then of no use.
  bool update(std::span<const PosedImage> keyframes, const std::atomic<bool>* stop = nullptr);

  const DenseMap& map() const { return *map_; }
  /// Null where none is kept.
  const FreeSpace* free() const { return free_.get(); }
  /// Where the keyframes were fused, by id.
  Trajectory path() const;
  /// Times that a keyframe was fused again since it had moved.
  long fused_again() const { return fused_again_; }

 private:
  /// What is to be done with the keyframes.
  struct Plan {
    std::vector<int> out;               ///< that are gone, or lie elsewhere now
    std::vector<const PosedImage*> in;  ///< that are new there
    std::size_t appended = 0;           ///< of these, new ones behind all others
  };

  bool has_moved(const Se3& from, const Se3& to) const;
  Plan plan(std::span<const PosedImage> keyframes) const;
  void begin_anew();
  /// Blocks that must be fused anew, cleared.
  std::vector<std::size_t> make_room(const Plan& plan);
  StaticView view_of(const PosedImage& keyframe) const;
  std::vector<std::size_t> all_blocks() const;

  const KeyframeFusionOptions options_;
  const DepthViewer viewer_;
  std::unique_ptr<DenseMap> map_;
  std::unique_ptr<FreeSpace> free_;
  std::map<int, PosedImage> fused_;
  long fused_again_ = 0;
};

}  // namespace dkp_slam
