#include "dkp_slam/system/back_end.h"

#include <limits>

#include "dkp_slam/trace.h"

namespace dkp_slam {

BackEnd::BackEnd(Map& map, PlaceIndex& places, const MeasurementModel& model,
                 const BackEndOptions& options, bool realtime, std::uint64_t seed)
    : map_(map),
      places_(places),
      model_(model),
      close_loops_(options.close_loops),
      followed_per_frame_(options.followed_per_frame),
      loop_closer_(options.loops, seed, realtime),
      mapper_(map, places, model, options.mapper, realtime) {}

void BackEnd::advance(int frame_index) {
  const TraceSpan span("back end");
  frame_index_ = frame_index;
  map_.follow_moves(followed_per_frame_);
  mapper_.advance(frame_index);
  if (loop_closer_.due(frame_index)) {
    if (mapper_.make_way_for_move()) loop_closer_.carry_out(map_);
  } else if (const auto closed = loop_closer_.advance(map_, places_, model_, frame_index)) {
    mapper_.adjust_whole(closed->keyframe);
  }
}

void BackEnd::insert_keyframe(Frame& frame) {
  const TraceSpan span("keyframe", frame.index);
  const int id = mapper_.insert_keyframe(frame);
  if (close_loops_) loop_closer_.add_keyframe(id);
  mapper_.adjust_around(id, frame.index);
}

void BackEnd::finish(bool full_adjustment, const std::atomic<bool>* stop) {
  while (loop_closer_.busy() && !(stop && *stop)) {
    if (loop_closer_.waiting()) {
      mapper_.wait();
      mapper_.make_way_for_move();
      loop_closer_.carry_out(map_);
    } else {
      loop_closer_.advance(map_, places_, model_, frame_index_, true);
    }
  }
  mapper_.finish(full_adjustment, stop);
  map_.follow_moves(std::numeric_limits<std::size_t>::max());
}

}  // namespace dkp_slam
