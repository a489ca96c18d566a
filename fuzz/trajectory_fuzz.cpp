// Trajectories in TUM format.
#include <cmath>

#include "dkp_slam/export/trajectory.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

void run(Bytes bytes) {
  const InputFile file(bytes);
  takes([&] {
    const Trajectory path = read_trajectory(file.path());
    require(!path.empty(), "a path of nothing");
    std::string written;
    const StampedPose* last = nullptr;
    for (const StampedPose& pose : path) {
      require(!last || pose.timestamp > last->timestamp, "time stamps that do not rise");
      require(pose.world_from_camera.translation.allFinite(), "a place that is none");
      require(std::abs(pose.world_from_camera.rotation.norm() - 1.0) < 1e-9, "no rotation");
      written += trajectory_line(pose);
      last = &pose;
    }
    const InputFile again(bytes_of(written));
    require(takes([&] { read_trajectory(again.path()); }), "what was written is refused");
  });
}

std::vector<std::string> seeds() {
  return {"# timestamp tx ty tz qx qy qz qw\n1.0 0 0 0 0 0 0 1\n1.5 0.1 -2 3e-3 0.5 0.5 0.5 0.5\n",
          "2,1,2,3,0,0,0,-2\n1\t+1 2 3 1e-3 0 0 0\n2 0 0 0 0 0 0 1\r\n"};
}

const Registration registration({"trajectory", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
