#include "ros/static_frames.h"

#include <gtest/gtest.h>

namespace dkp_slam::ros1 {
namespace {

Se3 at(double x, double y, double z, double yaw = 0.0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), {x, y, z}};
}

TEST(StaticFrames, JoinsFramesUpAndDownTheTree) {
  StaticFrames frames;
  frames.add("base", "mast", at(0.1, 0.0, 1.0));
  frames.add("/mast", "/camera", at(0.0, 0.2, 0.0, 1.5707963267948966));
  frames.add("base", "wheel", at(0.0, -0.3, 0.0));
  const auto base_from_camera = frames.between("base", "camera");
  ASSERT_TRUE(base_from_camera);
  // A metre ahead of the camera is a metre to the left of the mast.
  EXPECT_TRUE(
      (*base_from_camera * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(0.1, 1.2, 1)));
  const auto wheel_from_camera = frames.between("wheel", "camera");
  ASSERT_TRUE(wheel_from_camera);
  EXPECT_TRUE(wheel_from_camera->translation.isApprox(Eigen::Vector3d(0.1, 0.5, 1.0)));
  EXPECT_TRUE(frames.between("camera", "camera")->translation.isZero());
  EXPECT_TRUE((*frames.between("camera", "base") * *base_from_camera).translation.isZero(1e-12));
}

TEST(StaticFrames, SaysNothingOfWhatIsNotJoined) {
  StaticFrames frames;
  EXPECT_FALSE(frames.between("base", "camera"));
  frames.add("base", "mast", at(0, 0, 1));
  frames.add("other", "camera", at(0, 0, 1));
  EXPECT_FALSE(frames.between("base", "camera"));
  // The last one counts, and a circle is no way.
  frames.add("mast", "camera", at(0, 0, 1));
  EXPECT_EQ(frames.between("base", "camera")->translation.z(), 2.0);
  frames.add("camera", "mast", at(0, 0, 1));
  EXPECT_FALSE(frames.between("base", "camera"));
}

}  // namespace
}  // namespace dkp_slam::ros1
