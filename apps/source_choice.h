#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/layout/image_folder.h"
#include "dkp_slam/sensor/rgbd_source.h"

namespace dkp_slam::apps {

/// Where frames come from, as the user says it.
struct SourceChoice {
  std::string name;             ///< a folder, a bag, "-", "unix:PATH", "tcp:..." or "kinect"
  std::string camera;           ///< --camera; may be empty
  std::filesystem::path masks;  ///< of a folder; empty for none
  bool stream_masks = false;    ///< take those that a stream brings
  double reconnect = 30.0;      ///< seconds that a driver or a Kinect is waited for
  std::string topics;           ///< of a bag: "COLOUR,DEPTH[,CAMERA_INFO]"; empty: found
  double frame_rate = usual_frame_rate;  ///< Hz, of a folder without time stamps
};

/// "-", or a socket's address; else it is a folder or a bag.
bool is_stream(const std::string& name);
bool is_socket(const std::string& name);
/// A socket or a Kinect: it sends when it likes, not when it is asked.
bool is_live(const std::string& name);
/// A ROS 1 bag, or what is called like one.
bool is_bag_file(const std::string& name);

struct OpenedSource {
  std::unique_ptr<RgbdSource> source;
  Camera camera;
  std::string camera_name;  ///< its file, or who brought it
};

/// Opens a folder, a bag or a Kinect, or waits for the first driver of a stream. The camera is that
/// of --camera, else the stream's, bag's or folder's own or what the folder tells (choose_camera).
/// Ctrl-C ends the wait. Throws `Error`.
OpenedSource open_source(const SourceChoice& choice);

}  // namespace dkp_slam::apps
