#include "dkp_slam/dense/octomap/octomap_file.h"

#include <ostream>

#include <octomap/octomap.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam {

bool has_octomap() { return true; }
void check_octomap() {}

void write_octomap(const std::filesystem::path& file, const SurfaceMesh& mesh,
                   const FreeSpace& free) {
  if (mesh.vertices.empty()) {
    throw Error(file.string() + ": not written: there is no surface");
  }
  octomap::OcTree tree(free.cell());
  constexpr bool lazily = true;
  const auto set = [&](const Eigen::Vector3d& p, float value) {
    octomap::OcTreeKey key;
    if (tree.coordToKeyChecked(octomap::point3d(float(p.x()), float(p.y()), float(p.z())), key)) {
      tree.setNodeValue(key, value, lazily);
    }
  };
  const auto& blocks = free.grid();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Eigen::Vector3i first = blocks.place(b) * FreeSpace::Cells::side;
    for (int i = 0; i < FreeSpace::Cells::cells; ++i) {
      if (blocks.block(b)[static_cast<std::size_t>(i)] == 0) continue;
      set(free.centre(first + Eigen::Vector3i(i & 7, i >> 3 & 7, i >> 6)),
          tree.getClampingThresMinLog());
    }
  }
  for (const Eigen::Vector3f& v : mesh.vertices) {
    set(v.cast<double>(), tree.getClampingThresMaxLog());
  }
  tree.updateInnerOccupancy();
  tree.prune();
  // The library's own writer of the header tells the standard error when it is done.
  write_file_atomically(file, [&](std::ostream& out) {
    out << "# Octomap OcTree binary file\nid OcTree\nsize " << tree.size() << "\nres "
        << tree.getResolution() << "\ndata\n";
    tree.writeBinaryData(out);
  });
}

}  // namespace dkp_slam
