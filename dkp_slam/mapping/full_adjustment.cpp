#include "dkp_slam/mapping/full_adjustment.h"

#include <spdlog/spdlog.h>

#include "dkp_slam/mapping/local_bundle.h"

namespace dkp_slam {

void FullAdjustment::start(const Map& map, int which, int frame_index) {
  stop();
  if (map.live_keyframes_in(which) < 2) return;
  under_way_ = full_bundle(map, model_, which);
  if (under_way_.sightings.size() > options_.most_sightings) {
    spdlog::info("map of {} sightings: too large to be adjusted as a whole",
                 under_way_.sightings.size());
    return;
  }
  BundleOptions bundle;
  bundle.iterations = options_.iterations;
  due_frame_ = frame_index + options_.delay + map.live_keyframes_in(which);
  worker_.submit(under_way_, bundle);
}

bool FullAdjustment::due(int frame_index) const {
  return worker_.pending() && (realtime_ ? worker_.finished() : frame_index >= due_frame_);
}

void FullAdjustment::carry_back(Map& map) {
  const BundleSolution solution = worker_.take();
  apply_full_bundle(map, under_way_, solution);
  spdlog::debug("whole map adjusted: {} keyframes, {} landmarks", under_way_.poses.size(),
                under_way_.points.size());
  under_way_ = {};
  ++done_;
}

void FullAdjustment::stop() {
  if (worker_.pending()) worker_.cancel();
  under_way_ = {};
}

}  // namespace dkp_slam
