// dkp-slam as a node of ROS 1: a client of the door (docs/ros.md).
#include <atomic>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <ros/ros.h>
#include <boost/function.hpp>

#include "dkp_slam/dense/live/live_dense_map.h"
#include "dkp_slam/dense/occupancy_grid.h"
#include "dkp_slam/dense/surface_extraction.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "dkp_slam/system/map_file/run_map.h"
#include "dkp_slam/system/slam.h"
#include "ros/frame_input.h"
#include "ros/messages.h"
#include "ros/node_options.h"
#include "ros/static_frames.h"
#include "ros/world.h"

namespace dkp_slam::ros1 {
namespace {

LiveDenseOptions dense_options(const NodeOptions& node, const SlamConfig& config) {
  constexpr double on_a_robot = 500.0;  // megabytes
  LiveDenseOptions options;
  options.fusion.map.voxel = node.voxel;
  options.fusion.map.memory = on_a_robot;
  options.fusion.view.max_range = node.range;
  options.fusion.cell = node.cell;
  options.keyframes = node.dense_keyframes;
  options.live = config.realtime;
  options.at_once = false;
  return options;
}

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
        tf_(node_.advertise<TransformMessage>("/tf", 100)) {
    if (!options_.base_frame.empty()) listen_to_static_frames();
    input_ = std::make_unique<FrameInput>(
        node_, options_,
        FrameInput::Receiver{[this](const Camera& camera) { start(camera); },
                             [this](RgbdFrame frame, const ros::Time& stamp,
                                    const std::string& id) { feed(std::move(frame), stamp, id); }});
  }
  ~Node() {
    stop_threads();
    if (!slam_) return;
    const SlamCounters counters = slam_->counters();
    // rosconsole is gone by now.
    std::fprintf(stderr, "dkp_slam_node: %d frames, %d answered, %d dropped\n", counters.fed,
                 counters.answered, counters.dropped);
  }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// After the last frame: the map file holds all of the map. Throws what ended the node early.
  void finish() {
    stop_threads();
    if (failure_) std::rethrow_exception(failure_);
    if (!slam_ || options_.map_file.empty() || config_.localize_only) return;
    slam_->finish();
    map_file_->finish();
  }

 private:
  void listen_to_static_frames() {
    const boost::function<void(const boost::shared_ptr<const TransformMessage>&)> call =
        [this](const boost::shared_ptr<const TransformMessage>& message) {
          for (const auto& t : message->transforms) {
            frames_.add(t.header.frame_id, t.child_frame_id, pose_of(t.transform));
          }
        };
    constexpr std::uint32_t publishers = 100;
    static_frames_ = node_.subscribe<TransformMessage>("/tf_static", publishers, call);
  }

  void stop_threads() {
    input_.reset();
    stop_ = true;
    for (std::thread* thread : {&results_, &worlds_}) {
      if (thread->joinable()) thread->join();
    }
  }

  /// What ends the node: nothing goes on without it. By one of the threads, once.
  void fail(std::exception_ptr failure) {
    {
      const std::lock_guard lock(mutex_);
      if (failed_) return;
      failure_ = std::move(failure);
      failed_ = true;
    }
    ros::shutdown();
  }

  void start(const Camera& camera) {
    try {
      begin(camera);
    } catch (const Error&) {
      fail(std::current_exception());
    }
  }

  void begin(const Camera& camera) {
    config_.camera = camera;
    ROS_INFO("camera %d x %d, focal length %.1f pixels, mode %s", camera.width, camera.height,
             camera.fx, mode_info(config_.dynamics.mode).name);
    auto detector = mode_info(config_.dynamics.mode).detector
                        ? make_detector(config_.detector, camera)
                        : nullptr;
    const std::filesystem::path none;
    map_file_ = config_.localize_only ? std::make_shared<RunMap>(none, options_.map_file, config_)
                                      : std::make_shared<RunMap>(options_.map_file, none, config_);
    std::optional<Map> stored = map_file_->take_stored();
    const bool kept = map_file_->begin(config_);
    auto slam = std::make_unique<Slam>(config_, std::move(detector), std::move(stored));
    ObserverOptions watching;
    watching.delivery = Delivery::every;
    watching.inbox = 64;
    watching.map = true;
    watching.map_interval = options_.map_interval;
    slam->add_observer(world_, watching);
    if (kept) slam->add_observer(map_file_, watching);
    dense_ = std::make_shared<LiveDenseMap>(camera, dense_options(options_, config_));
    slam->add_observer(dense_, LiveDenseMap::watching(options_.map_interval));
    slam_ = std::move(slam);
    results_ = std::thread([this] { publish_results(); });
    worlds_ = std::thread([this] { publish_worlds(); });
  }

  void feed(RgbdFrame frame, const ros::Time& stamp, const std::string& frame_id) {
    if (failed_) return;
    {
      const std::lock_guard lock(mutex_);
      stamps_[frame.timestamp] = stamp;
      camera_frame_ = !options_.camera_frame.empty() ? options_.camera_frame
                      : frame_id.empty()             ? "camera"
                                                     : frame_id;
    }
    slam_->feed(std::move(frame));
  }

  /// Where the robot's base lies from the camera: the camera itself where there is none; nothing
  /// while /tf_static does not tell.
  std::optional<Se3> camera_from_base() {
    if (options_.base_frame.empty()) return Se3();
    const std::lock_guard lock(mutex_);
    auto found = frames_.between(camera_frame_, options_.base_frame);
    if (!found && !camera_frame_.empty()) {
      ROS_WARN_THROTTLE(10.0,
                        "/tf_static does not lead from %s to %s (~base_frame): nothing but ~state "
                        "is published until it does",
                        camera_frame_.c_str(), options_.base_frame.c_str());
    }
    return found;
  }

  /// The map's frame stands as the base stood, or as the camera did, at the first frame.
  MapFrame frame_of(int map, const ros::Time& stamp, const Se3& camera_from_base) const {
    MapFrame frame;
    frame.header.stamp = stamp;
    frame.header.frame_id = options_.map_frame;
    // Another map of the atlas has a world of its own.
    if (map > 0) frame.header.frame_id = fmt::format("{}_{}", options_.map_frame, map + 1);
    if (!options_.base_frame.empty()) frame.from_world = camera_from_base.inverse();
    return frame;
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
    const auto base = camera_from_base();
    if (!base) return;
    const MapFrame map = frame_of(result.map, stamp, *base);
    pose_.publish(pose_message(result, map));
    if (!options_.publish_tf) return;
    const std::lock_guard lock(mutex_);
    const std::string& child = options_.base_frame.empty() ? camera_frame_ : options_.base_frame;
    tf_.publish(transform_message(result, map, child, *base));
  }

  void publish_results() {
    try {
      while (!stop_) {
        while (const auto result = slam_->poll()) publish(*result);
        map_file_->rethrow_failure();
        constexpr auto look = std::chrono::milliseconds(2);
        std::this_thread::sleep_for(look);
      }
    } catch (const std::exception&) {
      fail(std::current_exception());
    }
  }

  /// Path and landmarks, and now and then the dense world, which takes its time.
  void publish_worlds() {
    long shown = 0, fused = -1;
    auto last_fused = std::chrono::steady_clock::time_point::min();
    while (!stop_) {
      constexpr auto look = std::chrono::milliseconds(100);
      std::this_thread::sleep_for(look);
      const auto base = camera_from_base();
      if (!base) continue;
      const long version = world_->version();
      const int map = map_;
      const MapFrame frame = frame_of(map, ros::Time::now(), *base);
      if (version != shown) {
        shown = version;
        path_.publish(path_message(world_->path(map), frame));
        landmarks_.publish(cloud_message(world_->landmarks(map), frame));
      }
      const std::chrono::duration<double> interval(options_.dense_interval);
      const auto now = std::chrono::steady_clock::now();
      const bool wanted = cloud_.getNumSubscribers() > 0 || grid_.getNumSubscribers() > 0;
      const long now_fused = dense_->version();
      if (!wanted || now_fused == fused || (fused >= 0 && now - last_fused < interval)) continue;
      if (!publish_dense(map, frame)) continue;
      fused = now_fused;
      last_fused = std::chrono::steady_clock::now();
    }
  }

  /// False where nothing is fused yet: it is from now on.
  bool publish_dense(int map, const MapFrame& frame) {
    try {
      return dense_->look(map, [&](const KeyframeFusion& fused) {
        const SurfaceMesh surface =
            extract_surface(fused.map(), {.least_views = SurfaceOptions::least_keyframes});
        cloud_.publish(cloud_message(surface, frame));
        publish_grid(surface, fused, frame);
      });
    } catch (const Error& error) {
      ROS_ERROR_THROTTLE(10.0, "no dense world: %s", error.what());
      return true;
    }
  }

  void publish_grid(const SurfaceMesh& surface, const KeyframeFusion& fused,
                    const MapFrame& frame) {
    if (surface.vertices.empty()) return;
    GridOptions band;
    band.low = options_.low;
    band.high = options_.high;
    band.cell = options_.cell;
    try {
      const OccupancyGrid grid =
          make_grid(surface, *fused.free(), find_level(surface, fused.path()), band);
      grid_.publish(grid_message(grid, frame));
    } catch (const Error&) {  // nothing was seen in the band yet
    }
  }

  const NodeOptions options_;
  SlamConfig config_;
  ros::NodeHandle node_, own_;
  ros::Publisher pose_, state_, path_, landmarks_, cloud_, grid_, tf_;
  ros::Subscriber static_frames_;
  StaticFrames frames_;
  const std::shared_ptr<World> world_ = std::make_shared<World>();
  std::shared_ptr<LiveDenseMap> dense_;
  std::shared_ptr<RunMap> map_file_;
  std::unique_ptr<Slam> slam_;
  std::mutex mutex_;  // of stamps_, camera_frame_ and failure_
  std::map<double, ros::Time> stamps_;
  std::string camera_frame_;
  std::atomic<int> map_{0};
  std::atomic<bool> stop_{false};
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;
  std::thread results_, worlds_;
  std::unique_ptr<FrameInput> input_;  // calls the others
};

}  // namespace
}  // namespace dkp_slam::ros1

int main(int argc, char** argv) {
  try {
    ros::init(argc, argv, "dkp_slam");
    dkp_slam::ros1::Node node(dkp_slam::ros1::read_parameters());
    ros::spin();
    node.finish();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "dkp_slam_node: %s\n", error.what());
    return 1;
  }
}
