// Camera files: what is read can be written and read again, the same.
#include "dkp_slam/sensor/camera_config.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

void run(Bytes bytes) {
  const std::string text = text_of(bytes);
  takes([&] {
    const Camera camera = parse_camera(text, "camera.yaml");
    require(!camera.check(), "a camera that is none");
    const std::string written = camera_text(camera);
    require(camera_text(parse_camera(written, "written")) == written,
            "written and read it differs");
  });
  const InputFile file(bytes);
  takes([&] { load_camera(file.path()); });
}

std::vector<std::string> seeds() {
  Camera camera;
  camera.name = "a \"camera\": #1";
  camera.fx = camera.fy = 525.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.distortion.k1 = -0.1;
  camera.readout = 0.02;
  camera.depth_readout = 0.01;
  camera.depth_correction = {0.01, -0.002};
  camera.depth_correction.distortion.coefficients << 0.01, -0.02, 0, 0, 0, 1e-3, 0, 0, 0.05;
  return {camera_text(camera),
          "width: 640\nheight: 480\nfx: 500\nfy: 500\ncx: 320\ncy: 240\ndepth_scale: 5000\n"
          "distortion: [0, 0, 0, 0, 0]\n",
          "{width: &a 64, height: *a, fx: .nan, fy: 1e400, cx: [], depth_scale: ~}"};
}

const Registration registration({"camera", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
