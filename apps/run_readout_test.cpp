#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/test_command.h"
#include "dkp_slam/sensor/camera_config.h"

namespace dkp_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class RunReadout : public testing::CommandTest {};

/// A flat that was rendered row after row, as a camera file tells that does and one that does not.
TEST_F(RunReadout, SaysThatTheCameraFilesReadoutIsWrong) {
  const std::string flat = folder_ / "flat";
  ASSERT_EQ(call({"synth", "flat_loop", "--frames", "240", "--width", "320", "--height", "240",
                  "--readout", "0.02", "--out", flat}),
            0)
      << stderr_;
  Camera camera = load_camera(flat + "/camera.yaml");
  EXPECT_EQ(camera.readout, 0.02);
  const auto change_by = [&](double readout) {
    camera.readout = readout;
    const std::string file = folder_ / "camera.yaml", out = folder_ / "out";
    save_camera(camera, file);
    EXPECT_EQ(call({"run", flat, "--camera", file, "--mode", "off", "--out", out}), 0) << stderr_;
    const auto summary = nlohmann::json::parse(std::ifstream(out + "/summary.json"));
    return summary.at("readout_check").at("change_ms").get<double>();
  };
  EXPECT_NEAR(change_by(0.02), 0.0, 4.0);
  EXPECT_THAT(stderr_, Not(HasSubstr("calibrate")));
  EXPECT_NEAR(change_by(0.0), 18.0, 6.0);
  EXPECT_THAT(stderr_, HasSubstr("warning: by the images the camera's readout is about"));
  EXPECT_THAT(stderr_, HasSubstr("dkp-slam calibrate"));
}

}  // namespace
}  // namespace dkp_slam
