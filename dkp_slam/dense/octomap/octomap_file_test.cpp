#include "dkp_slam/dense/octomap/octomap_file.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/dense/test_views.h"
#include "dkp_slam/error.h"
#include "dkp_slam/map_file/test_folder.h"

#ifdef DKP_SLAM_OCTOMAP
#include <octomap/octomap.h>
#endif

namespace dkp_slam {
namespace {

class OctomapFile : public testing::FolderTest {};

#ifdef DKP_SLAM_OCTOMAP

TEST_F(OctomapFile, OctomapReadsWhatIsOccupiedAndFree) {
  const Camera camera = testing::small_camera();
  FreeSpace free(camera, 0.1, 100.0);
  free.add(DepthViewer(camera).view(testing::seen(camera, testing::wall(2.05)), {}), 0.15);
  SurfaceMesh mesh;
  mesh.vertices = {{0.31F, -0.12F, 2.05F}};
  const auto file = folder_ / "room.bt";
  ASSERT_TRUE(has_octomap());
  write_octomap(file, mesh, free);
  octomap::OcTree tree(file.string());
  EXPECT_NEAR(tree.getResolution(), 0.1, 1e-9);
  const auto occupied = [&](double x, double y, double z) {
    const octomap::OcTreeNode* node = tree.search(x, y, z);
    return node ? (tree.isNodeOccupied(node) ? "occupied" : "free") : "unknown";
  };
  EXPECT_STREQ(occupied(0.31, -0.12, 2.05), "occupied");
  EXPECT_STREQ(occupied(0.0, 0.0, 1.0), "free");
  EXPECT_STREQ(occupied(0.0, 0.0, 2.5), "unknown");
  EXPECT_THROW(write_octomap(folder_ / "empty.bt", {}, free), Error);
}

#else

TEST_F(OctomapFile, WithoutOctomapItSaysWhatToInstall) {
  EXPECT_FALSE(has_octomap());
  try {
    check_octomap();
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("scripts/setup.sh --with dense"));
  }
}

#endif

}  // namespace
}  // namespace dkp_slam
