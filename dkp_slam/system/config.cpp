#include "dkp_slam/system/config.h"

#include "dkp_slam/config/option_list.h"
#include "dkp_slam/dynamics/modes.h"

namespace dkp_slam {

void SlamConfig::describe(OptionList& list) {
  std::vector<std::pair<DynamicsMode, std::string>> modes;
  for (const ModeInfo& m : dynamics_modes()) modes.emplace_back(m.mode, m.name);
  list.add("mode", dynamics.mode, modes, "what is removed");
  list.of_a_part();
  list.add("seed", seed, at_least(0), "", "of everything random");
  list.add("realtime", realtime, "never wait for anything; drop what comes too fast");
  list.add("localize_only", localize_only, "in a stored map, which stays as it is");
  list.add("close_loops", close_loops, "and merge maps that meet");
  list.add("final_adjustment", final_adjustment, "of the whole map, at the end");
  list.leave_out();  // the camera: a file of its own
  list.add_part("detector", detector, "finds objects that may move");
  list.add_part("dynamics", dynamics, "what moves, and which features are static");
  list.add_part("orb", orb, "features of an image");
  list.add_part("refill", refill, "more features where people leave little of the room to be seen");
  list.add_part("measurement", measurement, "how observations are weighted");
  list.add_part("places", places, "finds keyframes that look like a frame");
  list.add_part("tracking", tracking, "the pose of every frame");
  list.add_part("path", path, "the poses of all frames, once the last has come");
  list.add_part("mapping", mapping, "keyframes, landmarks, bundle adjustment");
  list.add_part("loop", loop, "finds and closes loops");
}

void SlamConfig::check() const { check_options(*this); }

}  // namespace dkp_slam
