#include "dkp_slam/evaluation/measure/sequence_name.h"

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

struct Case {
  const char *folder, *scenario, *paper;
  bool synthetic;
};

TEST(SequenceName, ThePapersSequencesAndTheirTwinsAreKnown) {
  for (const Case& c :
       {Case{"rgbd_dataset_freiburg3_walking_halfsphere", "", "W/half", false},
        Case{"freiburg3_walking_rpy", "", "W/rpy", false},
        Case{"fr3_walking_static", "", "W/static", false},
        Case{"fr3_walking_xyz", "", "W/xyz", false},
        Case{"rgbd_dataset_freiburg3_sitting_static", "", "S/static", false},
        Case{"sitting_xyz", "", "S/xyz", true}, Case{"sequence", "walking_xyz", "W/xyz", true},
        Case{"fr3_sitting_xyz", "walking_rpy", "W/rpy", true}}) {
    const auto found = paper_sequence(c.folder, c.scenario);
    ASSERT_TRUE(found.has_value()) << c.folder;
    EXPECT_EQ(found->name, c.paper);
    EXPECT_EQ(found->synthetic, c.synthetic) << c.folder;
  }
}

TEST(SequenceName, PartsAndOthersAreNot) {
  for (const char* folder : {"fr3_walking_halfsphere_50", "fr1_xyz", "composite_xyz_walking",
                             "rgbd_dataset_freiburg2_desk", "fr1_walking_xyz", "walking", ""}) {
    EXPECT_FALSE(paper_sequence(folder, "").has_value()) << folder;
  }
  EXPECT_FALSE(paper_sequence("walking_xyz", "crowd").has_value());
}

}  // namespace
}  // namespace dkp_slam
