#include "dkp_slam/system/back_end.h"

namespace dkp_slam {

BackEnd::BackEnd(Map& map, PlaceIndex& places, const MeasurementModel& model,
                 const BackEndOptions& options, bool realtime, std::uint64_t seed)
    : map_(map),
      places_(places),
      model_(model),
      close_loops_(options.close_loops),
      loop_closer_(options.loops, seed),
      mapper_(map, places, model, options.mapper, realtime) {}

void BackEnd::insert_keyframe(Frame& frame) {
  const int id = mapper_.insert_keyframe(frame);
  if (close_loops_ && loop_closer_.close(map_, places_, model_, id)) {
    frame.camera_from_world = map_.keyframe(id).camera_from_world;
    mapper_.adjust_whole(map_.current_map(), frame.index);
  }
  // Where maps were joined this one welds them: the keyframe's neighbours are of both now.
  mapper_.adjust_around(id, frame.index);
}

}  // namespace dkp_slam
