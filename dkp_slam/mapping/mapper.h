#pragma once

#include <deque>
#include <optional>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/mapping/full_adjustment.h"
#include "dkp_slam/mapping/local_bundle.h"
#include "dkp_slam/mapping/worker.h"

namespace dkp_slam {

class OptionList;

struct MapperOptions {
  /// Share of a keyframe's landmarks that three others must see as well for it to go.
  double redundant_share = 0.9;
  LocalBundleOptions local;
  BundleOptions bundle;
  /// Frames from a keyframe until its bundle adjustment is carried back into the map. A fixed
  /// number makes the result independent of how fast the machine is: who arrives early waits.
  int bundle_delay = 6;
  FullAdjustmentOptions full;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Grows the map: keyframes, landmarks, fusion, culling, and bundle adjustment, local and of the
/// whole, each in its own thread. Called by the tracking thread alone.
class Mapper {
 public:
  /// `realtime`: bundle adjustments are carried back as soon as they are done, and never waited
  /// for.
  Mapper(Map& map, PlaceIndex& places, const MeasurementModel& model, const MapperOptions& options,
         bool realtime = false);

  /// Makes the frame a keyframe and returns its id; the frame gets the new landmarks' ids and its
  /// reference keyframe.
  int insert_keyframe(Frame& frame);
  /// Starts the bundle adjustment about a keyframe, unless the map has no other. The one before
  /// has been carried back by `insert_keyframe`.
  void adjust_around(int keyframe, int frame_index);
  /// Starts the bundle adjustment of the whole map that a keyframe belongs to, as after a loop was
  /// closed there; one that is under way is stopped.
  void adjust_whole(int keyframe) { full_adjustment_.start(map_, keyframe); }
  /// Before the whole map is moved: carries the local bundle adjustment back and stops that of the
  /// whole. False where that would have to wait, in real time: then the map must not be moved yet.
  bool make_way_for_move();
  /// Waits for the local bundle adjustment, if one is under way, and carries it back.
  void wait() {
    if (worker_.pending()) carry_back();
  }
  /// To be called once per frame, before it is tracked: carries back what is due.
  void advance(int frame_index);
  /// True while a local bundle adjustment has been submitted and not carried back.
  bool adjusting() const { return worker_.pending(); }
  /// Loops and joins that the whole map has been adjusted after.
  int full_adjustments() const { return full_adjustment_.done(); }
  /// Ends what is under way, then adjusts every map as a whole once more, if wanted and until
  /// `stop` is set: then the solver ends at its next iteration, and its map stays as it was.
  void finish(bool full_adjustment, const std::atomic<bool>* stop = nullptr);

 private:
  struct Adjusted {
    BundleProblem problem;
    BundleSolution solution;
  };

  void create_landmarks(Frame& frame, int id, const std::vector<int>& feature_of_frame);
  void cull_landmarks(int newest_keyframe);
  void cull_keyframes(int newest_keyframe);
  void carry_back();

  Map& map_;
  PlaceIndex& places_;
  const MeasurementModel model_;
  const MapperOptions options_;
  const bool realtime_;
  FullAdjustment full_adjustment_;
  Worker<BundleProblem, Adjusted> worker_;
  int due_frame_ = 0;
  std::deque<int> recent_landmarks_;
};

}  // namespace dkp_slam
