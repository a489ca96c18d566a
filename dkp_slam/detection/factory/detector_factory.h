#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/detection/options/detector_options.h"
#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

/// The detector of the options' kind; null for none. Logs which one runs and, where it is motion
/// for want of a model, how to get one. Throws `Error` when a model was asked for (by kind, path or
/// DKP_SLAM_MODEL) and is missing or unusable, and when the camera makes no sense.
std::unique_ptr<Detector> make_detector(const DetectorOptions& options, const Camera& camera);

/// YOLOX behind the `Detector` interface: looks at the colour image alone and keeps no state, so
/// frames may come in any order. The network has run once when this returns: models that load but
/// do not run fail here, and the first frame takes no longer than the others. Throws `Error` when
/// the model is missing, unreadable or none of YOLOX, or an option is out of range. With the size
/// of the images that will come it computes no more of the network than they fill; others work,
/// too.
std::unique_ptr<Detector> make_yolox_detector(const YoloxOptions& options,
                                              const cv::Size& images = {});

/// Path of the YOLOX model to use: `wanted` when it is not empty, else environment variable
/// DKP_SLAM_MODEL, else the smallest of yolox_{nano,tiny,s,m,l,x}.onnx in models/ of the current
/// folder, in models/ beside the program, in ../share/dkp-slam/models (where an installation has
/// it), or in ~/.cache/dkp-slam. Nothing when there is none.
/// Throws `Error` when `wanted` or the variable names a file that does not exist.
std::optional<std::filesystem::path> find_model(const std::filesystem::path& wanted = {});

/// One line that tells a user how to get a model.
std::string model_advice();

}  // namespace dkp_slam
