// Stands in where OctoMap is not installed.
#include "dkp_slam/dense/octomap/octomap_file.h"
#include "dkp_slam/error.h"

namespace dkp_slam {

bool has_octomap() { return false; }

void check_octomap() {
  throw Error(
      "--octomap: this program was built without OctoMap; install it with `scripts/setup.sh --with "
      "dense` (liboctomap-dev) and build again");
}

void write_octomap(const std::filesystem::path&, const SurfaceMesh&, const FreeSpace&) {
  check_octomap();
}

}  // namespace dkp_slam
