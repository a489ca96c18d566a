#pragma once

#include <memory>
#include <optional>
#include <string>

#include "dkp_slam/sensor/bag/bag_topics.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/rgbd_source.h"

namespace dkp_slam {

struct BagOptions {
  CameraTopics topics;  ///< of colour, depth and its camera_info; what is empty is found
  /// Seconds between a colour and a depth image that still belong together, exclusive.
  double max_difference = 0.02;
};

/// Frames of a ROS 1 bag, or of a RealSense recording, which is one.
///
/// Colour and depth are paired by their stamps, each image used once; a stamp of 0 is replaced by
/// the time of recording. Depth of a RealSense recording is registered to colour by what the bag
/// says of the two cameras; that of other bags must be. An image that cannot be read is skipped
/// with a warning and counted; `read` throws when many in a row are.
class BagSource : public RgbdSource {
 public:
  /// Of the bag's camera_info of the colour images, where it has one.
  virtual const std::optional<Camera>& own_camera() const = 0;
  /// To be called before the first `read`: depth outside the camera's range becomes 0. Its
  /// depth_scale is not used: bags have their own (ROS: millimetres). Throws `Error` when the
  /// images have another size.
  virtual void use_camera(const Camera& camera) = 0;
};

/// Whether this file begins as a ROS 1 bag does.
bool is_bag(const std::string& file);

/// Whether the program was built with what reads bags.
bool can_read_bags();

/// Throws `Error` for what is no bag, has no index (recording was cut off), no colour or no depth
/// images, none that belong together, or encodings that are not known; and where the program was
/// built without rosbag.
std::unique_ptr<BagSource> open_bag(const std::string& file, const BagOptions& options = {});

}  // namespace dkp_slam
