#include "ros/frame_input.h"

#include <utility>

#include <ros/console.h>
#include <boost/function.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/bag/bag_topics.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/image_reader.h"

namespace dkp_slam::ros1 {
namespace {

ImageMessage holder_of(const boost::shared_ptr<const Image>& message) { return {message, {}}; }
ImageMessage holder_of(const boost::shared_ptr<const CompressedImage>& message) {
  return {{}, message};
}

}  // namespace

FrameInput::FrameInput(ros::NodeHandle& node, const NodeOptions& options, Receiver receiver)
    : receiver_(std::move(receiver)), pairing_(options.max_difference) {
  if (!options.camera.empty()) {
    camera_ = load_camera(options.camera);
    by_file_ = true;
    receiver_.camera(*camera_);
  }
  subscribe(node, options);
  // Images whose stamps differ wait for those that might lie nearer; when nothing more comes, they
  // need not.
  constexpr double patience = 0.1;  // seconds
  silence_ = node.createWallTimer(ros::WallDuration(patience), [this](const ros::WallTimerEvent&) {
    if ((ros::WallTime::now() - last_message_).toSec() > patience) hand_on(true);
  });
}

void FrameInput::subscribe(ros::NodeHandle& node, const NodeOptions& options) {
  const auto queue = static_cast<std::uint32_t>(options.queue);
  const auto listen = [&](auto message, const std::string& topic, bool colour) {
    using Message = decltype(message);
    const boost::function<void(const boost::shared_ptr<const Message>&)> call =
        [this, colour](const boost::shared_ptr<const Message>& m) { take(colour, m); };
    return node.subscribe<Message>(topic, queue, call, {}, ros::TransportHints().tcpNoDelay());
  };
  if (options.compressed) {
    colour_ = listen(CompressedImage(), "rgb/image/compressed", true);
    depth_ = listen(CompressedImage(), "depth/image/compressedDepth", false);
  } else {
    colour_ = listen(Image(), "rgb/image", true);
    depth_ = listen(Image(), "depth/image", false);
  }
  if (by_file_) return;
  const bool rectified = is_rectified(colour_.getTopic());
  const boost::function<void(const boost::shared_ptr<const CameraInfo>&)> call =
      [this, rectified](const boost::shared_ptr<const CameraInfo>& m) { take_info(*m, rectified); };
  info_ = node.subscribe<CameraInfo>("rgb/camera_info", queue, call);
}

void FrameInput::take_info(const CameraInfo& info, bool rectified) {
  if (camera_) return;
  try {
    const Camera camera = camera_of(values_of(info), rectified);
    receiver_.camera(camera);
    camera_ = camera;
    hand_on(false);
  } catch (const Error& error) {
    ROS_ERROR_THROTTLE(10.0, "%s: %s; give a camera file with ~camera", info_.getTopic().c_str(),
                       error.what());
  }
}

template <class Message>
void FrameInput::take(bool colour, const boost::shared_ptr<const Message>& message) {
  last_message_ = ros::WallTime::now();
  if (!camera_) {
    ROS_WARN_THROTTLE(10.0, "images come, but no camera_info: waiting for %s (or give ~camera)",
                      info_.getTopic().c_str());
  }
  const ros::Time stamp = message->header.stamp;
  Stamped stamped{holder_of(message), stamp, message->header.frame_id};
  if (colour) {
    pairing_.add_colour(stamp.toSec(), std::move(stamped));
  } else {
    pairing_.add_depth(stamp.toSec(), std::move(stamped));
  }
  hand_on(false);
}

void FrameInput::hand_on(bool settle) {
  if (!camera_) return;  // they wait for it
  while (const auto pair = pairing_.next(settle)) {
    try {
      use(*pair);
    } catch (const Error& error) {
      ROS_ERROR_THROTTLE(10.0, "frame at %.6f left out: %s", pair->colour_stamp, error.what());
    }
  }
}

void FrameInput::use(const Pairing::Pair& pair) {
  RgbdFrame frame;
  frame.timestamp = pair.colour_stamp;
  frame.depth_delay = pair.depth_stamp - pair.colour_stamp;
  frame.colour = colour_of(pair.colour.image.view());
  constexpr double millimetres = 1000.0;
  frame.depth = depth_of(pair.depth.image.view(), millimetres);
  keep_depth_range(frame.depth, camera_->min_depth, camera_->max_depth);
  receiver_.frame(std::move(frame), pair.colour.stamp, pair.colour.frame_id);
}

}  // namespace dkp_slam::ros1
