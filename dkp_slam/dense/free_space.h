#pragma once

#include <cstdint>

#include "dkp_slam/dense/block_grid.h"
#include "dkp_slam/dense/depth_view.h"

namespace dkp_slam {

/// Where views looked through: cells of a coarse grid, cell i being the cube from i to i + 1 times
/// `cell` metres in the world frame.
class FreeSpace {
 public:
  using Cells = BlockGrid<std::uint16_t>;

  /// `memory`: megabytes at most. Throws `Error` for a cell that is not 0.01 to 1 m.
  FreeSpace(const Camera& camera, double cell, double memory);

  /// Marks what lies between the camera and `margin` metres before the surfaces that it sees. What
  /// masks cover says nothing.
  void add(const StaticView& view, double margin);
  /// Takes back what `add` did with the same view and margin, to the last count unless memory had
  /// run out or a cell had reached its 65535 views.
  void remove(const StaticView& view, double margin);

  /// Views that looked through a cell, up to 65535.
  int views(const Eigen::Vector3i& cell) const {
    const std::uint16_t* seen = grid_.cell(cell);
    return seen ? *seen : 0;
  }
  Eigen::Vector3i cell_of(const Eigen::Vector3d& point) const {
    return (point / cell_).array().floor().cast<int>();
  }
  Eigen::Vector3d centre(const Eigen::Vector3i& cell) const {
    return (cell.cast<double>().array() + 0.5) * cell_;
  }
  double cell() const { return cell_; }
  const Cells& grid() const { return grid_; }
  /// Memory has run out: free space is missing.
  bool full() const { return full_; }

 private:
  void count(const StaticView& view, double margin, int step);
  void mark(const Eigen::Vector3d& from, const Eigen::Vector3d& to, int step);

  Camera camera_;
  double cell_;
  Cells grid_;
  BlockGrid<std::uint16_t> last_view_;  // that a cell was counted for
  std::uint16_t view_ = 0;
  bool full_ = false;
};

}  // namespace dkp_slam
