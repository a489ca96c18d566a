#include "apps/true_path.h"

#include <system_error>

#include "dkp_slam/export/trajectory.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;

Trajectory true_path(const fs::path& sequence, double frame_rate) {
  std::error_code error;
  if (!fs::is_directory(sequence, error)) return {};
  if (Trajectory path = layout_truth(sequence, frame_rate); !path.empty()) return path;
  const fs::path file = sequence / "groundtruth.txt";
  return fs::exists(file) ? read_trajectory(file) : Trajectory();
}

}  // namespace dkp_slam::apps
