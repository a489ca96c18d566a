// Feeds a folder in the TUM benchmark's format to dkp-slam and prints where the camera was, as
// lines of "timestamp x y z qx qy qz qw" (seconds, metres, world from camera).
#include <cstdio>
#include <exception>
#include <utility>

#include <dkp_slam/detection/factory/detector_factory.h>
#include <dkp_slam/sensor/camera_config.h>
#include <dkp_slam/sensor/tum_source.h>
#include <dkp_slam/system/slam.h>

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: minimal FOLDER CAMERA.yaml\n");
    return 2;
  }
  dkp_slam::SlamConfig config;
  config.camera = dkp_slam::load_camera(argv[2]);
  // YOLOX where its weights are found, else the motion detector.
  dkp_slam::Slam slam(config, dkp_slam::make_detector({}, config.camera));

  const auto source = dkp_slam::open_tum_folder(argv[1], config.camera);
  while (auto frame = source->read()) {
    slam.feed(std::move(*frame));
    while (const auto result = slam.poll()) {
      if (!result->localised) std::fprintf(stderr, "frame %d: lost\n", result->index);
    }
  }
  slam.finish();

  // The path with everything that was learned until the end.
  for (const dkp_slam::StampedPose& pose : slam.trajectory()) {
    const Eigen::Vector3d& t = pose.world_from_camera.translation;
    const Eigen::Quaterniond& q = pose.world_from_camera.rotation;
    std::printf("%.6f %.4f %.4f %.4f %.4f %.4f %.4f %.4f\n", pose.timestamp, t.x(), t.y(), t.z(),
                q.x(), q.y(), q.z(), q.w());
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "minimal: %s\n", error.what());
  return 1;
}
