#pragma once

#include <functional>
#include <optional>
#include <string>

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <ros/timer.h>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/sensor/bag/ros_messages.h"
#include "dkp_slam/sensor/rgbd_frame.h"
#include "dkp_slam/sensor/stamp_pairing.h"
#include "ros/node_options.h"

namespace dkp_slam::ros1 {

/// Subscribes to rgb/image, depth/image and rgb/camera_info and makes frames of them. Calls back on
/// the thread that spins.
class FrameInput {
 public:
  struct Receiver {
    std::function<void(const Camera&)> camera;  ///< once, before the first frame
    /// With the frame_id of its colour image.
    std::function<void(RgbdFrame, const ros::Time&, const std::string&)> frame;
  };

  /// Throws `Error` where the camera file cannot be read.
  FrameInput(ros::NodeHandle& node, const NodeOptions& options, Receiver receiver);

 private:
  struct Stamped {
    ImageMessage image;
    ros::Time stamp;
    std::string frame_id;
  };
  using Pairing = StampPairing<Stamped>;

  void subscribe(ros::NodeHandle& node, const NodeOptions& options);
  void take_info(const CameraInfo& info, bool rectified);
  template <class Message>
  void take(bool colour, const boost::shared_ptr<const Message>& message);
  void hand_on(bool settle);
  void use(const Pairing::Pair& pair);

  const Receiver receiver_;
  std::optional<Camera> camera_;
  bool by_file_ = false;
  Pairing pairing_;
  ros::Subscriber colour_, depth_, info_;
  ros::WallTimer silence_;
  ros::WallTime last_message_;
};

}  // namespace dkp_slam::ros1
