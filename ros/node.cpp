// dkp-slam as a node of ROS 1: a client of the door (docs/ros.md).
#include <atomic>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <ros/ros.h>

#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "dkp_slam/system/slam.h"
#include "ros/dense_world.h"
#include "ros/frame_input.h"
#include "ros/messages.h"
#include "ros/node_options.h"
#include "ros/world.h"

namespace dkp_slam::ros1 {
namespace {

class Node {
 public:
  explicit Node(const NodeParameters& parameters)
      : options_(parameters.node),
        config_(parameters.slam),
        own_("~"),
        pose_(own_.advertise<PoseMessage>("pose", 100)),
        state_(own_.advertise<StringMessage>("state", 1000)),
        path_(own_.advertise<PathMessage>("path", 1, true)),
        landmarks_(own_.advertise<PointCloud>("landmarks", 1, true)),
        cloud_(own_.advertise<PointCloud>("cloud", 1, true)),
        grid_(own_.advertise<OccupancyGridMessage>("grid", 1, true)),
        tf_(node_.advertise<TransformMessage>("/tf", 100)),
        input_(node_, options_,
               {[this](const Camera& camera) { start(camera); },
                [this](RgbdFrame frame, const ros::Time& stamp, const std::string& id) {
                  feed(std::move(frame), stamp, id);
                }}) {}
  ~Node() {
    stop_ = true;
    for (std::thread* thread : {&results_, &worlds_}) {
      if (thread->joinable()) thread->join();
    }
    if (!slam_) return;
    const SlamCounters counters = slam_->counters();
    // rosconsole is gone by now.
    std::fprintf(stderr, "dkp_slam_node: %d frames, %d answered, %d dropped\n", counters.fed,
                 counters.answered, counters.dropped);
  }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

 private:
  void start(const Camera& camera) {
    config_.camera = camera;
    ROS_INFO("camera %d x %d, focal length %.1f pixels, mode %s", camera.width, camera.height,
             camera.fx, mode_info(config_.dynamics.mode).name);
    auto detector = mode_info(config_.dynamics.mode).detector
                        ? make_detector(config_.detector, camera)
                        : nullptr;
    world_ = std::make_shared<World>(camera, options_.dense_keyframes);
    slam_ = std::make_unique<Slam>(config_, std::move(detector));
    ObserverOptions watching;
    watching.delivery = Delivery::every;
    watching.inbox = 64;
    watching.map = true;
    watching.map_interval = options_.map_interval;
    slam_->add_observer(world_, watching);
    results_ = std::thread([this] { publish_results(); });
    worlds_ = std::thread([this] { publish_worlds(); });
  }

  void feed(RgbdFrame frame, const ros::Time& stamp, const std::string& frame_id) {
    {
      const std::lock_guard lock(mutex_);
      stamps_[frame.timestamp] = stamp;
      camera_frame_ = !options_.camera_frame.empty() ? options_.camera_frame
                      : frame_id.empty()             ? "camera"
                                                     : frame_id;
    }
    slam_->feed(std::move(frame));
  }

  Header header_of(int map, const ros::Time& stamp) const {
    Header header;
    header.stamp = stamp;
    header.frame_id = options_.map_frame;
    // Another map of the atlas has a world of its own.
    if (map > 0) header.frame_id = fmt::format("{}_{}", options_.map_frame, map + 1);
    return header;
  }

  /// The stamp as it came, to the nanosecond.
  ros::Time stamp_of(double timestamp) {
    const std::lock_guard lock(mutex_);
    const auto stamp = stamps_.find(timestamp);
    const ros::Time result = stamp == stamps_.end() ? ros::Time(timestamp) : stamp->second;
    stamps_.erase(stamps_.begin(), stamps_.upper_bound(timestamp));
    return result;
  }

  void publish(const FrameResult& result) {
    const ros::Time stamp = stamp_of(result.timestamp);
    state_.publish(state_message(result));
    if (!result.localised) return;
    map_ = result.map;
    const Header header = header_of(result.map, stamp);
    pose_.publish(pose_message(result, header));
    if (!options_.publish_tf) return;
    const std::lock_guard lock(mutex_);
    tf_.publish(transform_message(result, header, camera_frame_));
  }

  void publish_results() {
    try {
      while (!stop_) {
        while (const auto result = slam_->poll()) publish(*result);
        constexpr auto look = std::chrono::milliseconds(2);
        std::this_thread::sleep_for(look);
      }
    } catch (const std::exception& error) {
      ROS_FATAL("%s", error.what());
      ros::shutdown();
    }
  }

  /// Path and landmarks, and now and then the dense world, which takes its time.
  void publish_worlds() {
    long shown = 0, fused = 0;
    auto last_fused = std::chrono::steady_clock::time_point::min();
    while (!stop_) {
      constexpr auto look = std::chrono::milliseconds(100);
      std::this_thread::sleep_for(look);
      const long version = world_->version();
      const int map = map_;
      const Header header = header_of(map, ros::Time::now());
      if (version != shown) {
        shown = version;
        path_.publish(path_message(world_->path(map), header));
        landmarks_.publish(cloud_message(world_->landmarks(map), header));
      }
      const std::chrono::duration<double> interval(options_.dense_interval);
      const auto now = std::chrono::steady_clock::now();
      const bool wanted = cloud_.getNumSubscribers() > 0 || grid_.getNumSubscribers() > 0;
      if (!wanted || version == fused ||
          (fused > 0 && std::chrono::duration<double>(now - last_fused) < interval)) {
        continue;
      }
      fused = version;
      publish_dense(map, header);
      last_fused = std::chrono::steady_clock::now();
    }
  }

  void publish_dense(int map, const Header& header) {
    try {
      const auto frames = world_->frames(map);
      if (frames.empty()) return;
      const DenseWorld dense = fuse(frames, world_->small_camera(), options_);
      cloud_.publish(cloud_message(dense.surface, header));
      if (dense.grid) grid_.publish(grid_message(*dense.grid, header));
    } catch (const Error& error) {
      ROS_ERROR_THROTTLE(10.0, "no dense world: %s", error.what());
    }
  }

  const NodeOptions options_;
  SlamConfig config_;
  ros::NodeHandle node_, own_;
  ros::Publisher pose_, state_, path_, landmarks_, cloud_, grid_, tf_;
  std::shared_ptr<World> world_;
  std::unique_ptr<Slam> slam_;
  std::mutex mutex_;  // of stamps_ and camera_frame_
  std::map<double, ros::Time> stamps_;
  std::string camera_frame_;
  std::atomic<int> map_{0};
  std::atomic<bool> stop_{false};
  std::thread results_, worlds_;
  FrameInput input_;  // last: it calls the others
};

}  // namespace
}  // namespace dkp_slam::ros1

int main(int argc, char** argv) {
  try {
    ros::init(argc, argv, "dkp_slam");
    dkp_slam::ros1::Node node(dkp_slam::ros1::read_parameters());
    ros::spin();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "dkp_slam_node: %s\n", error.what());
    return 1;
  }
}
