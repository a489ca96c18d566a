#include "dkp_slam/dense/occupancy_grid.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2i;
using Eigen::Vector3d;

constexpr int most_cells = 100'000'000;

void check(const GridOptions& options) {
  if (!(options.low < options.high && std::abs(options.low) < 100.0 && options.high < 100.0)) {
    throw Error(fmt::format("grid: the band from {} m to {} m is none", options.low, options.high));
  }
  if (!(options.cell >= 0.01 && options.cell <= 1.0)) {
    throw Error(fmt::format("grid: a cell of {} m is not between 0.01 and 1 m", options.cell));
  }
}

/// Cells of the grid that something says something of.
class Marks {
 public:
  Marks(const GridOptions& options, const Se3& level_from_world)
      : options_(options), level_from_world_(level_from_world) {}

  void add(const Vector3d& world, GridCell what) {
    const Vector3d p = level_from_world_ * world;
    if (p.z() < options_.low || p.z() > options_.high) return;
    const Vector2i at = (p.head<2>() / options_.cell).array().floor().cast<int>();
    low_ = low_.cwiseMin(at);
    high_ = high_.cwiseMax(at);
    (what == GridCell::occupied ? occupied_ : free_).push_back(at);
  }

  OccupancyGrid grid() const {
    if (occupied_.empty() && free_.empty()) {
      throw Error(
          fmt::format("grid: nothing was seen from {} m to {} m above the floor; choose "
                      "another --band",
                      options_.low, options_.high));
    }
    const Vector2i size = high_ - low_ + Vector2i::Ones();
    if (double(size.x()) * double(size.y()) > most_cells) {
      throw Error(fmt::format("grid: {} x {} cells are too many; take larger ones (--cell)",
                              size.x(), size.y()));
    }
    OccupancyGrid grid;
    grid.resolution = options_.cell;
    grid.origin = low_.cast<double>() * options_.cell;
    grid.level_from_world = level_from_world_;
    grid.cells.create(size.y(), size.x(), CV_8UC1);
    grid.cells.setTo(static_cast<int>(GridCell::unknown));
    const auto fill = [&](const std::vector<Vector2i>& cells, GridCell what) {
      for (const Vector2i& c : cells) {
        grid.cells.at<std::uint8_t>(high_.y() - c.y(), c.x() - low_.x()) =
            static_cast<std::uint8_t>(what);
      }
    };
    fill(free_, GridCell::free);
    fill(occupied_, GridCell::occupied);
    return grid;
  }

 private:
  GridOptions options_;
  Se3 level_from_world_;
  std::vector<Vector2i> occupied_, free_;
  Vector2i low_ = Vector2i::Constant(1 << 30), high_ = Vector2i::Constant(-(1 << 30));
};

std::string yaml_of(const std::filesystem::path& image, const OccupancyGrid& grid) {
  const Eigen::Quaterniond& q = grid.level_from_world.rotation;
  const Vector3d& t = grid.level_from_world.translation;
  return fmt::format(
      "# The grid's frame (z up, floor at 0) from the trajectory's world: tx ty tz qx qy qz qw\n"
      "# {:.6f} {:.6f} {:.6f} {:.9f} {:.9f} {:.9f} {:.9f}\n"
      "image: {}\nresolution: {:g}\norigin: [{:.6f}, {:.6f}, 0.000000]\nnegate: 0\n"
      "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
      t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), image.filename().string(), grid.resolution,
      grid.origin.x(), grid.origin.y());
}

}  // namespace

OccupancyGrid make_grid(const SurfaceMesh& mesh, const FreeSpace& free, const LevelFrame& level,
                        const GridOptions& options) {
  check(options);
  Marks marks(options, level.level_from_world);
  for (const Eigen::Vector3f& v : mesh.vertices) marks.add(v.cast<double>(), GridCell::occupied);
  const auto& blocks = free.grid();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Eigen::Vector3i first = blocks.place(b) * FreeSpace::Cells::side;
    for (int i = 0; i < FreeSpace::Cells::cells; ++i) {
      if (blocks.block(b)[static_cast<std::size_t>(i)] == 0) continue;
      const Eigen::Vector3i cell = first + Eigen::Vector3i(i & 7, i >> 3 & 7, i >> 6);
      // The two grids are turned against each other: eight points of each cell leave no gaps.
      for (int k = 0; k < 8; ++k) {
        const Vector3d part = Vector3d(k & 1, k >> 1 & 1, k >> 2) - Vector3d::Constant(0.5);
        marks.add(free.centre(cell) + 0.5 * free.cell() * part, GridCell::free);
      }
    }
  }
  return marks.grid();
}

void write_grid(const std::filesystem::path& pgm, const OccupancyGrid& grid) {
  std::string text = fmt::format("P5\n{} {}\n255\n", grid.cells.cols, grid.cells.rows);
  for (int y = 0; y < grid.cells.rows; ++y) {
    text.append(reinterpret_cast<const char*>(grid.cells.ptr(y)),
                static_cast<std::size_t>(grid.cells.cols));
  }
  std::filesystem::path yaml = pgm;
  yaml.replace_extension(".yaml");
  check_writable(yaml);
  write_file_atomically(pgm, text);
  write_file_atomically(yaml, yaml_of(pgm, grid));
}

}  // namespace dkp_slam
