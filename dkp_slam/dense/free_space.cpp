#include "dkp_slam/dense/free_space.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

constexpr double dense_until = 4.0;  // metres: as far as rays lie no farther apart than cells

std::size_t blocks_of_both(double megabytes) {
  constexpr double bytes = 4.0 * FreeSpace::Cells::cells + 160.0;  // with the tables that find them
  return static_cast<std::size_t>(std::max(1.0, megabytes * 1e6 / bytes));
}

}  // namespace

FreeSpace::FreeSpace(const Camera& camera, double cell, double memory)
    : camera_(camera),
      cell_(cell),
      grid_(blocks_of_both(memory)),
      last_view_(blocks_of_both(memory)) {
  if (!(cell >= 0.01 && cell <= 1.0)) {
    throw Error(fmt::format("free space: a cell of {} m is not between 0.01 and 1 m", cell));
  }
}

void FreeSpace::add(const StaticView& view, double margin) { count(view, margin, 1); }

void FreeSpace::remove(const StaticView& view, double margin) { count(view, margin, -1); }

void FreeSpace::count(const StaticView& view, double margin, int step) {
  if (++view_ == 0) ++view_;  // 0 is no view
  const int pixels = std::max(1, static_cast<int>(camera_.fx * cell_ / dense_until));
  const Eigen::Matrix3d rotation = view.world_from_camera.rotation.toRotationMatrix();
  const Eigen::Vector3d& origin = view.world_from_camera.translation;
  for (int v = pixels / 2; v < view.nearest.rows; v += pixels) {
    const auto* row = view.nearest.ptr<float>(v);
    for (int u = pixels / 2; u < view.nearest.cols; u += pixels) {
      if (row[u] <= 0.0F) continue;
      const double free = row[u] - margin;
      if (free <= camera_.min_depth) continue;
      const Eigen::Vector3d ray = rotation * camera_.unproject({double(u), double(v)}, 1.0);
      mark(origin + camera_.min_depth * ray, origin + free * ray, step);
    }
  }
}

void FreeSpace::mark(const Eigen::Vector3d& from, const Eigen::Vector3d& to, int step) {
  const int cells = std::max(1, static_cast<int>(std::ceil((to - from).norm() / cell_)));
  const Eigen::Vector3d stride = (to - from) / cells;
  // A ray stays in a block for some cells, which need not be looked for anew.
  Cells::Block* seen = nullptr;
  BlockGrid<std::uint16_t>::Block* last = nullptr;
  Eigen::Vector3i there = Eigen::Vector3i::Constant(1 << 30);
  for (int i = 0; i <= cells; ++i) {
    const Eigen::Vector3i cell = cell_of(from + double(i) * stride);
    const Eigen::Vector3i block = Cells::block_of(cell);
    if (block != there) {
      there = block;
      const bool room = grid_.add(block) && last_view_.add(block);
      full_ = full_ || !room;
      seen = room ? grid_.find(block) : nullptr;
      last = room ? last_view_.find(block) : nullptr;
    }
    if (!seen) continue;
    const std::size_t index = Cells::index_in_block(cell);
    if ((*last)[index] == view_) continue;
    (*last)[index] = view_;
    std::uint16_t& views = (*seen)[index];
    if (step > 0 ? views < UINT16_MAX : views > 0) views = static_cast<std::uint16_t>(views + step);
  }
}

}  // namespace dkp_slam
