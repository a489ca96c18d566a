#include "dkp_slam/dense/occupancy_grid.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "dkp_slam/dense/test_views.h"
#include "dkp_slam/error.h"
#include "dkp_slam/map_file/test_folder.h"
#include "tests/support/file_text.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

/// World axes of a camera that looks ahead, 1 m above the floor; the level frame's x is ahead.
LevelFrame level_of_camera() {
  Eigen::Matrix3d rows;
  rows << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {Se3(Eigen::Quaterniond(rows), {0, 0, 1}), true};
}

/// A wall 2 m ahead of a camera, in points, and what the camera sees before it.
struct Seen {
  SurfaceMesh mesh;
  FreeSpace free{testing::small_camera(), 0.05, 100.0};

  Seen() {
    const Camera camera = testing::small_camera();
    const DepthViewer viewer(camera);
    free.add(viewer.view(testing::seen(camera, testing::wall(2.02)), {}), 0.1);
    for (int i = -20; i <= 20; ++i) {
      mesh.vertices.emplace_back(0.02F * static_cast<float>(i), 0.1F, 2.02F);
      mesh.normals.emplace_back(0.0F, 0.0F, -1.0F);
    }
  }
};

GridCell cell_at(const OccupancyGrid& grid, double x, double y) {
  const int column = static_cast<int>(std::floor((x - grid.origin.x()) / grid.resolution));
  const int row = static_cast<int>(std::floor((y - grid.origin.y()) / grid.resolution));
  return GridCell{grid.cells.at<std::uint8_t>(grid.cells.rows - 1 - row, column)};
}

TEST(OccupancyGrid, TellsOccupiedFreeAndUnknown) {
  const Seen seen;
  const OccupancyGrid grid = make_grid(seen.mesh, seen.free, level_of_camera());
  EXPECT_EQ(cell_at(grid, 2.02, 0.0), GridCell::occupied);
  EXPECT_EQ(cell_at(grid, 2.02, 0.38), GridCell::occupied);
  EXPECT_EQ(cell_at(grid, 2.02, 0.55), GridCell::unknown) << "beside the points";
  EXPECT_EQ(cell_at(grid, 1.0, 0.0), GridCell::free);
  EXPECT_EQ(cell_at(grid, 1.8, 0.9), GridCell::free) << "y is to the left";
  EXPECT_EQ(cell_at(grid, 0.5, 0.6), GridCell::unknown) << "out of view";
  // The band ends below the wall's points, 0.9 m above the floor.
  GridOptions low;
  low.high = 0.8;
  const OccupancyGrid below = make_grid(seen.mesh, seen.free, level_of_camera(), low);
  EXPECT_FALSE(cv::countNonZero(below.cells == static_cast<int>(GridCell::occupied)));
  GridOptions above;
  above.low = 50.0;
  above.high = 60.0;
  EXPECT_THROW(make_grid(seen.mesh, seen.free, level_of_camera(), above), Error);
}

class GridFiles : public testing::FolderTest {
 protected:
  std::string content(const std::string& name) const { return testing::content(folder_ / name); }
};

TEST_F(GridFiles, AreWhatMapServerReads) {
  OccupancyGrid grid;
  grid.cells = (cv::Mat_<std::uint8_t>(2, 3) << 0, 205, 254, 254, 254, 0);
  grid.origin = {-1.25, 0.5};
  write_grid(folder_ / "room.pgm", grid);
  EXPECT_EQ(content("room.pgm"),
            std::string("P5\n3 2\n255\n") + std::string("\0\xCD\xFE\xFE\xFE\0", 6));
  EXPECT_THAT(content("room.yaml"),
              ::testing::EndsWith("image: room.pgm\nresolution: 0.05\n"
                                  "origin: [-1.250000, 0.500000, 0.000000]\nnegate: 0\n"
                                  "occupied_thresh: 0.65\nfree_thresh: 0.196\n"));
  EXPECT_THROW(write_grid(folder_ / "none" / "room.pgm", grid), Error);
}

}  // namespace
}  // namespace dkp_slam
