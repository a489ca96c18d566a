#pragma once

#include <filesystem>
#include <string>

#include "dkp_slam/config/option_list.h"
#include "dkp_slam/system/config.h"

namespace dkp_slam::ros1 {

/// Parameters of the node beside those of the system.
struct NodeOptions {
  std::filesystem::path camera;  ///< file; empty: by camera_info
  std::filesystem::path config;  ///< file
  bool compressed = false;
  double max_difference = 0.02;
  int queue = 30;
  std::string map_frame = "map";
  std::string camera_frame;        ///< empty: that of the colour images
  std::string base_frame;          ///< empty: tf has the camera itself
  std::filesystem::path map_file;  ///< empty: the map is not kept
  bool publish_tf = true;
  double map_interval = 1.0;
  double dense_interval = 5.0;
  int dense_keyframes = 300;
  double voxel = 0.03;
  double range = 4.0;
  double cell = 0.05;
  double low = 0.1, high = 1.8;

  void describe(OptionList& list);
};

struct NodeParameters {
  NodeOptions node;
  SlamConfig slam;
};

/// Reads the private parameters: ~config, then every other one, ~voxel and the like and every field
/// of the configuration, ~tracking/local_keyframes for tracking.local_keyframes. The system runs
/// live unless ~realtime says otherwise. Throws `Error`, which names the parameter, for one that
/// does not exist, has the wrong type or is out of bounds.
NodeParameters read_parameters();

}  // namespace dkp_slam::ros1
