// What the tests play is what would be rendered for them.
#include "tests/support/recording.h"

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using testing::Recording;

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         cv::norm(a.reshape(1), b.reshape(1), cv::NORM_INF) == 0.0;
}

TEST(Recordings, AreWhatIsRendered) {
  // Twice: rendered for this or taken from a longer one, and surely found.
  for (const Recording& found :
       {Recording("walking_xyz", 3, 90, 2), Recording("walking_xyz", 2, 90, 2)}) {
    const Recording made("walking_xyz", found.camera, found.frames.size(), 90);
    ASSERT_EQ(made.frames.size(), found.frames.size());
    for (std::size_t i = 0; i < made.frames.size(); ++i) {
      EXPECT_EQ(found.frames[i].index, made.frames[i].index);
      EXPECT_EQ(found.frames[i].timestamp, made.frames[i].timestamp);
      EXPECT_TRUE(same(found.frames[i].colour, made.frames[i].colour));
      EXPECT_TRUE(same(found.frames[i].depth, made.frames[i].depth));
      EXPECT_TRUE(same(found.truths[i].instance, made.truths[i].instance));
      EXPECT_TRUE(same(found.truths[i].mask, made.truths[i].mask));
      EXPECT_EQ(found.truth[i].timestamp, made.truth[i].timestamp);
      EXPECT_EQ(found.truth[i].world_from_camera.translation,
                made.truth[i].world_from_camera.translation);
      EXPECT_EQ(found.truth[i].world_from_camera.rotation.coeffs(),
                made.truth[i].world_from_camera.rotation.coeffs());
      const auto &objects = found.truths[i].objects, &exact = made.truths[i].objects;
      ASSERT_EQ(objects.size(), exact.size());
      ASSERT_FALSE(exact.empty());
      for (std::size_t k = 0; k < exact.size(); ++k) {
        EXPECT_EQ(objects[k].instance, exact[k].instance);
        EXPECT_EQ(objects[k].class_name, exact[k].class_name);
        EXPECT_EQ(objects[k].box, exact[k].box);
        EXPECT_EQ(objects[k].pixels, exact[k].pixels);
      }
    }
  }
}

TEST(Recordings, SayWhatCannotBeRendered) { EXPECT_THROW(Recording("running_xyz", 3), Error); }

}  // namespace
}  // namespace dkp_slam
