#pragma once

#include <atomic>
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
};

/// What becomes of a keyframe, in its order: the mapper takes it in, the loop closer looks whether
/// the place is known, then bundle adjustment begins. Called by the tracking thread alone.
class BackEnd {
 public:
  /// `realtime`: bundle adjustments are never waited for. `seed`: of everything random.
  BackEnd(Map& map, PlaceIndex& places, const MeasurementModel& model,
          const BackEndOptions& options, bool realtime = false, std::uint64_t seed = 1);

  /// To be called once per frame, before it is tracked: carries back what is due.
  void advance(int frame_index) { mapper_.advance(frame_index); }
  /// True while a local bundle adjustment has been submitted and not carried back.
  bool adjusting() const { return mapper_.adjusting(); }
  /// Makes the frame a keyframe; the frame gets the new landmarks' ids and its reference keyframe,
  /// and another pose where that closed a loop.
  void insert_keyframe(Frame& frame);
  /// See Mapper::finish.
  void finish(bool full_adjustment, const std::atomic<bool>* stop = nullptr) {
    mapper_.finish(full_adjustment, stop);
  }
  /// Loops closed and maps joined so far.
  const std::vector<ClosedLoop>& loops() const { return loop_closer_.closed(); }

 private:
  Map& map_;
  PlaceIndex& places_;
  const MeasurementModel model_;
  const bool close_loops_;
  LoopCloser loop_closer_;
  Mapper mapper_;
};

}  // namespace dkp_slam
