#include "dkp_slam/dynamics/parts.h"

#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using Names = std::vector<std::string>;

Names parts_of(DynamicsMode mode) {
  Camera camera;
  camera.fx = camera.fy = 525.0;
  DynamicsOptions options;
  options.mode = mode;
  return make_parts(camera, options).names();
}

TEST(Parts, OffHasNone) { EXPECT_EQ(parts_of(DynamicsMode::off), Names()); }

TEST(Parts, MasksHasWhatTheMasksLeaveOpen) {
  EXPECT_EQ(parts_of(DynamicsMode::masks),
            (Names{"given masks", "flow", "ego-motion", "given mask rule"}));
}

TEST(Parts, PaperHasThoseOfTheText) {
  EXPECT_EQ(parts_of(DynamicsMode::paper),
            (Names{"object tracker", "flow", "masks by Algorithm 1", "region and epipolar rule",
                   "flow compensation"}));
}

TEST(Parts, TheAblationDiffersByItsRuleAlone) {
  const Names common = {"object tracker with carried boxes",
                        "flow",
                        "ego-motion",
                        "static planes",
                        "static background",
                        "masks by clusters and surfaces"};
  const auto with = [&](const char* rule) {
    Names all = common;
    all.emplace_back(rule);
    return all;
  };
  EXPECT_EQ(parts_of(DynamicsMode::d), with("box rule"));
  EXPECT_EQ(parts_of(DynamicsMode::dk), with("mask rule"));
  EXPECT_EQ(parts_of(DynamicsMode::dkp), with("region and epipolar rule"));
}

TEST(Parts, OursSeesMotionToo) {
  EXPECT_EQ(parts_of(DynamicsMode::dkp_plus),
            (Names{"object tracker with carried boxes", "flow", "ego-motion", "long baseline",
                   "static planes", "static background", "masks by clusters and surfaces",
                   "moving surfaces", "residual rule"}));
}

TEST(Modes, AreKnownByName) {
  for (const ModeInfo& m : dynamics_modes()) {
    EXPECT_EQ(mode_named(m.name), m.mode);
    EXPECT_EQ(mode_info(m.mode).name, std::string(m.name));
    EXPECT_EQ(m.own_tracking, m.mode != DynamicsMode::paper);
    EXPECT_EQ(m.detector, m.mode != DynamicsMode::off && m.mode != DynamicsMode::masks);
  }
  EXPECT_EQ(mode_names(), "{off,masks,paper,d,dk,dkp,dkp+}");
  EXPECT_THROW(mode_named("DKP"), Error);
}

}  // namespace
}  // namespace dkp_slam
