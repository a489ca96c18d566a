#include "apps/camera_choice.h"

#include <map>

#include <fmt/format.h>

#include "apps/process.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/sequence_name.h"
#include "dkp_slam/sensor/layout/image_folder.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, std::string> cameras_by_name{
    {"fr1", "tum_fr1.yaml"},  {"fr2", "tum_fr2.yaml"},  {"fr3", "tum_fr3.yaml"},
    {"bonn", "bonn.yaml"},    {"icl", "icl_nuim.yaml"}, {"7scenes", "seven_scenes.yaml"},
    {"kinect", "kinect.yaml"}};

/// One of the camera files that come with the program.
fs::path shipped_camera(const std::string& file) {
  std::error_code error;
  const fs::path program = fs::read_symlink(this_program, error).parent_path();
  for (const fs::path& folder :
       {program / "config", program / "../share/dkp-slam/config", fs::path(DKP_SLAM_CONFIG_DIR)}) {
    if (fs::exists(folder / file)) return folder / file;
  }
  throw Error(file + ": the program's folder of camera files is missing; give one with --camera");
}

/// Empty where the name says nothing.
std::string file_by_name(const std::string& sequence) {
  try {
    return camera_file(sequence);
  } catch (const Error&) {
    return "";
  }
}

}  // namespace

fs::path choose_camera(const fs::path& folder, const std::string& wanted) {
  if (const auto known = cameras_by_name.find(wanted); known != cameras_by_name.end()) {
    return shipped_camera(known->second);
  }
  if (!wanted.empty()) {
    if (fs::is_regular_file(wanted)) return wanted;
    throw Error(
        fmt::format("{}: no such camera file, nor one of {}; see --camera", wanted, camera_names));
  }
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);  // a name also for "." and "there/"
  if (error) throw Error(folder.string() + ": no such folder; check the path");
  if (fs::exists(real / "camera.yaml")) return folder / "camera.yaml";
  for (const std::string& file : {published_camera(real), file_by_name(real.filename())}) {
    if (!file.empty()) return shipped_camera(file);
  }
  throw Error(
      fmt::format("{}: has no camera.yaml and its name does not tell its camera; give one with "
                  "--camera: a file, or one of {}",
                  folder.string(), camera_names));
}

}  // namespace dkp_slam::apps
