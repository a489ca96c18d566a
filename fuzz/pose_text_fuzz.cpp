// Pose and intrinsics files of 7-Scenes and ScanNet, and ICL-NUIM's true paths.
#include <cmath>
#include <limits>

#include "dkp_slam/sensor/layout/image_layout.h"
#include "dkp_slam/sensor/layout/pose_text.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

void require_pose(const Se3& pose) {
  require(pose.translation.allFinite(), "a place that is none");
  require(std::abs(pose.rotation.norm() - 1.0) < 1e-9, "no rotation");
}

void run(Bytes bytes) {
  const std::string text = text_of(bytes);
  takes([&] {
    if (const auto pose = pose_of_matrix(parse_matrix(text, "pose"), "pose")) require_pose(*pose);
  });
  takes([&] {
    const Intrinsics found = intrinsics_of_matrix(parse_matrix(text, "intrinsics"), "intrinsics");
    require(found.fx > 0.0 && found.fy > 0.0, "a focal length that is none");
    require(std::isfinite(found.fx * 0.0 + found.fy * 0.0 + found.cx * 0.0 + found.cy * 0.0),
            "intrinsics that are not finite");
  });
  const InputFile file(bytes);
  takes([&] {
    double last = -std::numeric_limits<double>::infinity();
    for (const StampedPose& pose : read_icl_truth(file.path(), 30.0)) {
      require(pose.timestamp > last, "time stamps that do not rise");
      last = pose.timestamp;
      require_pose(pose.world_from_camera);
    }
  });
}

std::vector<std::string> seeds() {
  return {"1 0 0 0.5\n0 1 0 -2e-1\n0 0 1 3\n0 0 0 1\n",
          "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n",
          "577.87 0 319.5 0\n0 578.73 239.5 0\n0 0 1 0\n0 0 0 1\n",
          "1 0 0 -2.25 0 0 0 1\n2 0.001 -0.01 -2.25 0.5 0.5 0.5 -0.5\r\n"};
}

const Registration registration({"pose_text", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
