#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/localization/matcher.h"
#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/loop/essential_graph.h"
#include "dkp_slam/loop/loop_detector.h"
#include "dkp_slam/loop/place_joining.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/map/map_snapshot.h"
#include "dkp_slam/mapping/worker.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

class OptionList;

struct LoopCloserOptions {
  LoopDetectorOptions detector;
  PoseGraphOptions graph;
  int least_matches = 40;  ///< landmarks of the old place that the new keyframe must show
  int least_shared = 100;  ///< landmarks that make two keyframes an edge of the essential graph
  /// Of a loop's edge against all others. Those repeat one and the same drift many times, as
  /// neighbours at every distance, and would outvote it.
  double loop_weight = 30.0;
  int fused_neighbours = 8;  ///< keyframes about the new one whose landmarks are fused as well
  /// Frames from the snapshot of the poses until the map is put right: this many, and one more per
  /// so many keyframes. A fixed number makes the result independent of how fast the machine is: who
  /// arrives early waits.
  int delay = 10;
  int keyframes_per_frame_of_delay = 20;
  /// What one frame does at most, so that none waits for long (2,000 keyframes: 2 ms at most).
  int gathered_per_frame = 500;  ///< keyframe ids that come into the snapshot
  int effort_per_frame = 1500;   ///< of fusing landmarks, see landmark_fusion.h

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// A loop that was closed, or a place where two maps met.
struct ClosedLoop {
  int keyframe = -1, old_keyframe = -1;
  int matches = 0;     ///< landmarks of the old place found in the new keyframe
  double moved = 0.0;  ///< metres by which the new keyframe was put right; 0 where maps met
  bool joined_maps = false;
};

/// Closes loops and joins maps (Mur-Artal et al. 2015, section VII, with a scale that is known):
/// detection, alignment of the new keyframe to the landmarks of the old place, pose graph over the
/// essential graph, correction of keyframes and landmarks, and fusion of landmarks that are the
/// same. Where the old place lies in another map, that map and this one become one instead, as they
/// are.
///
/// All of it runs beside the tracker. Other threads align the keyframe and solve the pose graph, on
/// snapshots; the rest belongs to the tracking thread, which does a bounded part of it per frame.
/// While one loop is under way no other is looked for: where the place stays in view it is found
/// after that.
class LoopCloser {
 public:
  /// `seed`: of the alignment's RANSAC. `realtime`: the map is put right as soon as the pose graph
  /// is solved.
  explicit LoopCloser(const LoopCloserOptions& options = {}, std::uint64_t seed = 1,
                      bool realtime = false);

  /// To be called with each new keyframe in turn, once it is in the map and the index.
  void add_keyframe(int keyframe);
  /// To be called once per frame: the next part of what is under way. When that was the last of a
  /// loop, the loop: its landmarks are fused, and the whole map may be adjusted. `wait`: for an
  /// alignment that is under way, as is always done but in real time.
  std::optional<ClosedLoop> advance(Map& map, const PlaceIndex& places,
                                    const MeasurementModel& model, int frame_index,
                                    bool wait = false);
  /// Whether the map is to be put right now, by `carry_out`.
  bool due(int frame_index) const;
  /// Puts the map right, waiting for the pose graph where it must. To be called when nothing else
  /// is under way that was made for the map as it was.
  void carry_out(Map& map);

  /// Whether a loop was found, and the snapshot for it is being taken.
  bool gathering() const { return stage_ == Stage::gathering; }
  /// Whether a loop was found that `carry_out` has not been called for, and only waits for it.
  bool waiting() const { return stage_ == Stage::solving; }
  /// Whether `advance` or `carry_out` has anything left to do.
  bool busy() const;

  /// All so far that the map was put right for.
  const std::vector<ClosedLoop>& closed() const { return closed_; }

 private:
  enum class Stage { looking, aligning, gathering, solving, fusing };

  /// A keyframe and an older one that it may show.
  struct Meeting {
    Frame seen;  // the keyframe, knowing nothing
    Excerpt old;
    MeasurementModel model;
    std::uint64_t seed = 0;
  };
  struct Alignment {
    Frame seen;                       // with the pose that the older keyframe gives it
    std::vector<FrameMatch> matches;  // that agree on it, by ids in the map; empty when none do
  };
  static Alignment align(Meeting meeting);

  void look(const Map& map, const PlaceIndex& places, const MeasurementModel& model);
  void try_next_candidate(const Map& map, const MeasurementModel& model);
  /// Whether the alignment holds in the map as it is now; then the loop goes on from it.
  bool accept(const Map& map, const MeasurementModel& model, Alignment alignment);
  void submit(int frame_index);
  /// Ends what is under way.
  void look_again();

  struct Problem {
    EssentialGraph graph;
    std::vector<LoopEdge> loops;
  };
  struct Solution {
    MapMove move;
    int first_later = 0;
  };

  const LoopCloserOptions options_;
  const std::uint64_t seed_;
  const bool realtime_;
  LoopDetector detector_;
  Stage stage_ = Stage::looking;
  std::deque<int> waiting_;     // keyframes to look at, the first one under way
  std::deque<int> candidates_;  // that it may close a loop with, still to be aligned
  ClosedLoop loop_;             // under way
  Se3 keyframe_from_old_;
  std::vector<int> seen_;  // landmarks of the old place, per feature of the keyframe
  std::optional<EssentialGraph> graph_;
  std::optional<PlaceFusion> fusion_;
  int due_frame_ = 0;
  std::vector<LoopEdge> loops_;  // closed before, both of whose keyframes were there the last time
  std::vector<ClosedLoop> closed_;
  Worker<Meeting, Alignment> aligner_;
  Worker<Problem, Solution> solver_;
};

}  // namespace dkp_slam
