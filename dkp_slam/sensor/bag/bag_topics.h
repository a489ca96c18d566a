#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dkp_slam {

/// A topic of a bag.
struct BagTopic {
  std::string name, type;
  std::uint64_t messages = 0;
};

/// Topics of an RGB-D camera; those that the bag does not have are empty.
struct CameraTopics {
  std::string colour, depth;
  std::string colour_info, depth_info;  ///< sensor_msgs/CameraInfo
  /// Of RealSense recordings: geometry_msgs/Transform from the device to each camera, and
  /// std_msgs/Float32, metres a unit of depth.
  std::string colour_pose, depth_pose, depth_unit;
};

/// Finds colour and depth by type and name, unless `wanted` names them, and what belongs to them.
/// Among several the registered depth is taken before the others, what is not compressed before
/// what is, then the first by name. Throws `Error`, which lists the images there are, where one is
/// missing.
CameraTopics choose_topics(const std::vector<BagTopic>& topics, const CameraTopics& wanted = {});

/// "COLOUR,DEPTH" or "COLOUR,DEPTH,CAMERA_INFO", as on the command line. Throws `Error`.
CameraTopics parse_topics(const std::string& text);

/// Whether the name says that its images were rectified.
bool is_rectified(const std::string& topic);

}  // namespace dkp_slam
