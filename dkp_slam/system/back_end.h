#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/loop/loop_closer.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/mapping/mapper.h"

namespace dkp_slam {

struct BackEndOptions {
  MapperOptions mapper;
  LoopCloserOptions loops;
  bool close_loops = true;
  /// Landmarks that one frame lets follow a move of the map (see Map::move), so that none waits for
  /// long: half a millisecond.
  std::size_t followed_per_frame = 4000;
};

/// What becomes of a keyframe: the mapper takes it in and begins with bundle adjustment, and the
/// loop closer looks whether the place is known. Both work beside the tracker. Called by the
/// tracking thread alone.
class BackEnd {
 public:
  /// `realtime`: bundle adjustments are never waited for. `seed`: of everything random.
  BackEnd(Map& map, PlaceIndex& places, const MeasurementModel& model,
          const BackEndOptions& options, bool realtime = false, std::uint64_t seed = 1);

  /// To be called once per frame, before it is tracked: carries back what is due, and does a
  /// bounded part of what else is under way.
  void advance(int frame_index);
  /// True while a local bundle adjustment has been submitted and not carried back.
  bool adjusting() const { return mapper_.adjusting(); }
  /// Makes the frame a keyframe; the frame gets the new landmarks' ids and its reference keyframe.
  void insert_keyframe(Frame& frame);
  /// Brings a loop that is under way to its end, unless `stop` is set; then see Mapper::finish.
  void finish(bool full_adjustment, const std::atomic<bool>* stop = nullptr);
  /// Adjustments of a whole map carried back so far.
  int whole_adjustments() const { return mapper_.full_adjustments(); }
  /// Loops closed and maps joined so far.
  const std::vector<ClosedLoop>& loops() const { return loop_closer_.closed(); }

 private:
  Map& map_;
  PlaceIndex& places_;
  const MeasurementModel model_;
  const bool close_loops_;
  const std::size_t followed_per_frame_;
  LoopCloser loop_closer_;
  Mapper mapper_;
  int frame_index_ = 0;  // of the last frame
};

}  // namespace dkp_slam
