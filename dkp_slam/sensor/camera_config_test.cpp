#include "dkp_slam/sensor/camera_config.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using ::testing::HasSubstr;

const std::string valid =
    "name: test\n"
    "width: 640\n"
    "height: 480\n"
    "fx: 500.5\n"
    "fy: 501.5\n"
    "cx: 320\n"
    "cy: 240\n"
    "distortion: [0.1, -0.2, 0.003, -0.004, 0.5]\n"
    "depth_scale: 1000\n";

std::string write_camera(const std::string& text) {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  const std::string path = ::testing::TempDir() + info->name() + ".yaml";
  std::ofstream(path) << text;
  return path;
}

/// The error that loading `text` gives, without the path before the line number.
std::string error_of(const std::string& text) {
  const std::string path = write_camera(text);
  try {
    load_camera(path);
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind(path, 0), 0U) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message.substr(path.size());
  }
  return "no error";
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = valid;
  return text.replace(text.find(from), from.size(), to);
}

TEST(CameraConfig, ReadsAllFields) {
  const Camera camera =
      load_camera(write_camera(
          valid + "min_depth: 0.4\nmax_depth: 5\nbaseline: 0.05\nframe_rate: 15\nreadout: 0.03\n"
                  "depth_readout: 0.01\ndepth_noise:\n  constant: 0.002\n  quadratic: 0\n"));
  EXPECT_EQ(camera.name, "test");
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.fx, 500.5);
  EXPECT_EQ(camera.fy, 501.5);
  EXPECT_EQ(camera.cx, 320.0);
  EXPECT_EQ(camera.cy, 240.0);
  EXPECT_EQ(camera.distortion.k1, 0.1);
  EXPECT_EQ(camera.distortion.k2, -0.2);
  EXPECT_EQ(camera.distortion.p1, 0.003);
  EXPECT_EQ(camera.distortion.p2, -0.004);
  EXPECT_EQ(camera.distortion.k3, 0.5);
  EXPECT_EQ(camera.depth_scale, 1000.0);
  EXPECT_EQ(camera.min_depth, 0.4);
  EXPECT_EQ(camera.max_depth, 5.0);
  EXPECT_EQ(camera.baseline, 0.05);
  EXPECT_EQ(camera.frame_rate, 15.0);
  EXPECT_EQ(camera.readout, 0.03);
  EXPECT_EQ(camera.depth_readout, 0.01);
  EXPECT_EQ(camera.depth_noise.constant, 0.002);
  EXPECT_EQ(camera.depth_noise.quadratic, 0.0);
}

TEST(CameraConfig, ReadsTheFilesThatComeWithTheProgram) {
  const std::string folder = DKP_SLAM_CONFIG_FOLDER;
  EXPECT_EQ(load_camera(folder + "/tum_fr1.yaml").distortion.k3, 1.1633);
  EXPECT_EQ(load_camera(folder + "/tum_fr2.yaml").cx, 325.1);
  EXPECT_TRUE(load_camera(folder + "/tum_fr3.yaml").distortion.none());
  EXPECT_EQ(load_camera(folder + "/tum_fr3.yaml").fy, 539.2);
  EXPECT_EQ(load_camera(folder + "/bonn.yaml").fx, 542.822841);
}

TEST(CameraConfig, ReadsBackWhatItWrites) {
  Camera camera = load_camera(write_camera(valid));
  camera.name = "a \"quoted\": name # here";
  camera.fx = 1.0 / 3.0 * 1500.0;
  camera.depth_noise.quadratic = 0.00123456789012345;
  camera.readout = 0.0123;
  const std::string path = write_camera("");
  save_camera(camera, path);
  const Camera back = load_camera(path);
  EXPECT_EQ(back.name, camera.name);
  EXPECT_EQ(back.fx, camera.fx);
  EXPECT_EQ(back.distortion.p2, camera.distortion.p2);
  EXPECT_EQ(back.depth_scale, camera.depth_scale);
  EXPECT_EQ(back.readout, camera.readout);
  EXPECT_EQ(back.depth_readout, std::nullopt);
  EXPECT_EQ(back.depth_noise.quadratic, camera.depth_noise.quadratic);
  camera.depth_readout = 0.0;
  save_camera(camera, path);
  EXPECT_EQ(load_camera(path).depth_readout, 0.0);
}

TEST(CameraConfig, ReadsWhatDepthIsOffBy) {
  const std::string path =
      write_camera(valid +
                   "depth_delay: -0.02\ndepth_bias: 0.1\n"
                   "depth_distortion: [0.01, -0.02, 0.03, 0, 0, 0, 1e-3, 0, 0.09]\n");
  const Camera camera = load_camera(path);
  const DepthCorrection& depth = camera.depth_correction;
  EXPECT_EQ(depth.delay, -0.02);
  EXPECT_EQ(depth.bias, 0.1);
  EXPECT_EQ(depth.distortion.coefficients[1], -0.02);
  EXPECT_EQ(depth.distortion.coefficients[6], 1e-3);
  EXPECT_EQ(depth.distortion.coefficients[8], 0.09);
  save_camera(camera, path);
  EXPECT_EQ(load_camera(path).depth_correction.distortion.coefficients,
            depth.distortion.coefficients);
  EXPECT_EQ(load_camera(path).depth_correction.delay, -0.02);
  save_camera(camera.of_corrected_images(), path);
  EXPECT_TRUE(load_camera(path).depth_correction.distortion.none());
  EXPECT_EQ(load_camera(path).depth_correction.delay, 0.0);
  EXPECT_TRUE(load_camera(write_camera(valid)).depth_correction.distortion.none());
}

TEST(CameraConfig, NamesLineAndFieldOfBadValues) {
  EXPECT_THAT(error_of(with("fx: 500.5", "fx: 0")), HasSubstr(":4: fx"));
  EXPECT_THAT(error_of(with("fx: 500.5", "fx: -3")), HasSubstr(":4: fx"));
  EXPECT_THAT(error_of(with("fx: 500.5", "fx: 500.5\ndepth_readout: -0.01")),
              HasSubstr(":5: depth_readout: depth_readout must lie between 0 and"));
  EXPECT_THAT(error_of(with("fy: 501.5", "fy: .nan")), HasSubstr(":5: fy: must be finite"));
  EXPECT_THAT(error_of(with("fy: 501.5", "fy: nan")), HasSubstr(":5: fy: must be a number"));
  EXPECT_THAT(error_of(with("cx: 320", "cx: .inf")), HasSubstr(":6: cx: must be finite"));
  EXPECT_THAT(error_of(with("cy: 240", "cy: wide")), HasSubstr(":7: cy: must be a number"));
  EXPECT_THAT(error_of(with("cy: 240", "cy: [1, 2]")), HasSubstr(":7: cy: must be a number"));
  EXPECT_THAT(error_of(with("cy: 240", "cy: 500")), HasSubstr(":7: cy"));
  EXPECT_THAT(error_of(with("cy: 240", "cy:")), HasSubstr(":7: cy: must be a number"));
  EXPECT_THAT(error_of(with("width: 640", "width: 640.5")), HasSubstr(":2: width"));
  EXPECT_THAT(error_of(with("-0.2,", "")), HasSubstr(":8: distortion: must be five numbers"));
  EXPECT_THAT(error_of(with("-0.2", ".nan")), HasSubstr(":8: distortion: must be finite"));
  EXPECT_THAT(error_of(valid + "depth_distortion: [0.1]\n"),
              HasSubstr(":10: depth_distortion: must be nine numbers"));
  EXPECT_THAT(error_of(valid + "depth_distortion: 0.1\n"), HasSubstr("must be nine numbers"));
  EXPECT_THAT(error_of(valid + "depth_distortion: [0, 0, 0, 0, 0, 0, 0, 0, .nan]\n"),
              HasSubstr(":10: depth_distortion: must be finite"));
  EXPECT_THAT(error_of(valid + "depth_distortion: [0, 0, 0, 0, 0, 0, 0, 0, 0.2]\n"),
              HasSubstr("must be numbers between -0.1 and 0.1 1/metre"));
  EXPECT_THAT(error_of(valid + "max_depth: 0.1\n"), HasSubstr("min_depth and max_depth"));
  EXPECT_THAT(error_of(valid + "depth_noise: 3\n"), HasSubstr(":10:"));
  EXPECT_THAT(error_of(valid + "depth_noise:\n  linear: 3\n"),
              HasSubstr(":11: unknown key depth_noise.linear; valid keys are constant, quadratic"));
}

TEST(CameraConfig, NamesMissingUnknownAndRepeatedFields) {
  EXPECT_THAT(error_of(with("fx: 500.5\n", "")), HasSubstr("fx is missing"));
  EXPECT_THAT(error_of(with("depth_scale: 1000\n", "")), HasSubstr("depth_scale is missing"));
  EXPECT_THAT(error_of(with("fx:", "[f, x]:")), HasSubstr(":4: a key's name must stand"));
  EXPECT_THAT(error_of(with("fx:", "f_x:")), HasSubstr(":4: unknown key f_x; valid keys are name"));
  EXPECT_THAT(error_of(valid + "fx: 3\n"), HasSubstr(":10: fx was set before on line 4"));
}

TEST(CameraConfig, RefusesWhatIsNoCameraFile) {
  EXPECT_THAT(error_of(""), HasSubstr("key: value"));
  EXPECT_THAT(error_of("- 1\n- 2\n"), HasSubstr("key: value"));
  EXPECT_THAT(error_of("fx: [1, 2\nfy: 3\n"), HasSubstr("not valid YAML"));
  EXPECT_THROW(load_camera("/no/such/camera.yaml"), Error);
  EXPECT_THROW(load_camera(::testing::TempDir()), Error);
}

}  // namespace
}  // namespace dkp_slam
