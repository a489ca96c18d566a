#pragma once

#include <memory>
#include <string>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/rgbd_source.h"
#include "dkp_slam/sensor/tum_options.h"

namespace dkp_slam {

/// Opens a folder in the format of the TUM RGB-D benchmark (the Bonn RGB-D Dynamic Dataset uses it
/// too): associations.txt, or rgb.txt and depth.txt, and the images they name. Colour is PNG, JPEG
/// or whatever else OpenCV reads, depth a 16-bit PNG of `camera.depth_scale` units per metre; depth
/// outside the camera's range becomes 0.
///
/// Throws `Error` when the folder or a list is missing, empty or malformed, when no colour image
/// has a depth image, and when the first readable frame has the wrong depth type or another size
/// than the camera. Later, `read` skips frames whose images are missing or damaged, and throws when
/// more than half of all frames are lost or an image has the wrong type or size.
///
/// Masks: throws when the folder is missing or has none for any colour image, and, at once or in
/// `read`, when one has the wrong type or size or is damaged. A colour image without one comes
/// without one, with a warning the first time, and is counted.
std::unique_ptr<RgbdSource> open_tum_folder(const std::string& folder, const Camera& camera,
                                            const TumOptions& options = {});

}  // namespace dkp_slam
