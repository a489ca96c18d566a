// The node, as a robot has it: a roscore of its own, a bag that is played in real time, and
// somebody who listens.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <boost/function.hpp>

#include "apps/test_sequence.h"
#include "dkp_slam/map_file/test_folder.h"
#include "dkp_slam/sensor/bag/test_bag.h"
#include "dkp_slam/sensor/tum_source.h"
#include "ros/messages.h"

namespace dkp_slam::ros1 {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::TestBag;
using dkp_slam::testing::WallSequence;
using ::testing::HasSubstr;

constexpr int frame_count = 20;

/// A process that ends with it.
class Started {
 public:
  Started(std::vector<std::string> words, const fs::path& log) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawnp(&id_, arguments[0], &actions, nullptr, arguments.data(), environ) != 0)
      id_ = 0;
    posix_spawn_file_actions_destroy(&actions);
  }
  ~Started() { end(); }
  /// Exit code.
  int end(int with = SIGINT) {
    if (id_ == 0) return -1;
    if (with != 0) ::kill(id_, with);
    int status = 0;
    ::waitpid(id_, &status, 0);
    id_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }

 private:
  pid_t id_ = 0;
};

bool wait_until(const std::function<bool()>& condition) {
  constexpr int most = 3000;  // half a minute
  for (int i = 0; i < most && !condition(); ++i) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  }
  return condition();
}

std::string content(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

class RosNode : public dkp_slam::testing::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    // Nobody else's master, and nothing in the user's home.
    const std::string port = std::to_string(20000 + ::getpid() % 20000);
    ::setenv("ROS_MASTER_URI", ("http://127.0.0.1:" + port).c_str(), 1);
    ::setenv("ROS_IP", "127.0.0.1", 1);
    ::setenv("ROS_HOME", folder_.c_str(), 1);
    ::setenv("ROSCONSOLE_STDOUT_LINE_BUFFERED", "1", 1);
    core_ = std::make_unique<Started>(std::vector<std::string>{"roscore", "-p", port},
                                      folder_ / "core.log");
    ros::M_string none;
    ros::init(none, "listener", ros::init_options::NoSigintHandler);
    for (int i = 0; i < 300 && !ros::master::check(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    ASSERT_TRUE(ros::master::check()) << content(folder_ / "core.log");
  }
  std::unique_ptr<Started> node(const std::vector<std::string>& parameters) const {
    std::vector<std::string> words{DKP_SLAM_NODE};
    words.insert(words.end(), parameters.begin(), parameters.end());
    return std::make_unique<Started>(words, folder_ / "node.log");
  }
  std::string log() const { return content(folder_ / "node.log"); }
  std::string bag() const { return folder_ / "wall.bag"; }
  void write_bag() const {
    const WallSequence sequence(folder_ / "sequence", frame_count);
    TestBag out(bag());
    const Camera& camera = sequence.camera;
    const auto source = open_tum_folder(sequence.folder(), camera);
    while (const auto frame = source->read()) {
      const double t = frame->timestamp;
      cv::Mat millimetres;
      frame->depth.convertTo(millimetres, CV_16U, 1000.0);
      out.info("/rgb/camera_info", t, {camera.width, camera.height}, camera.fx);
      out.image("/rgb/image", t, frame->colour, "bgr8");
      out.image("/depth/image", t, millimetres, "16UC1");
    }
  }

  std::unique_ptr<Started> core_;
};

// One test, for a process can be a node of one master only.
TEST_F(RosNode, AnswersEveryFrameOfABagAndSaysWhatIsWrong) {
  {
    const auto wrong = node({"_tracking/locl_keyframes:=60"});
    EXPECT_EQ(wrong->end(0), 1);
    EXPECT_THAT(log(), HasSubstr("~tracking.locl_keyframes: is no parameter"));
    EXPECT_THAT(log(), HasSubstr("tracking.local_keyframes"));
    ros::NodeHandle().deleteParam("/dkp_slam/tracking/locl_keyframes");
  }
  write_bag();
  // It waits for room instead of dropping what a busy machine has no time for.
  const auto started = node({"_mode:=off", "_realtime:=false", "_queue:=100", "_map_interval:=0.1",
                             "_dense_interval:=0.5", "_camera_frame:=eye"});
  ros::NodeHandle handle;
  std::vector<std::string> states;
  std::vector<PoseMessage> poses;
  int transforms = 0;
  std::size_t path = 0, landmarks = 0, cloud = 0;
  const boost::function<void(const boost::shared_ptr<const StringMessage>&)> on_state =
      [&](const boost::shared_ptr<const StringMessage>& m) { states.push_back(m->data); };
  const boost::function<void(const boost::shared_ptr<const PoseMessage>&)> on_pose =
      [&](const boost::shared_ptr<const PoseMessage>& m) { poses.push_back(*m); };
  const boost::function<void(const boost::shared_ptr<const TransformMessage>&)> on_tf =
      [&](const boost::shared_ptr<const TransformMessage>& m) {
        if (m->transforms.at(0).child_frame_id == "eye") ++transforms;
      };
  const boost::function<void(const boost::shared_ptr<const PathMessage>&)> on_path =
      [&](const boost::shared_ptr<const PathMessage>& m) { path = m->poses.size(); };
  const boost::function<void(const boost::shared_ptr<const PointCloud>&)> on_landmarks =
      [&](const boost::shared_ptr<const PointCloud>& m) { landmarks = m->width; };
  const boost::function<void(const boost::shared_ptr<const PointCloud>&)> on_cloud =
      [&](const boost::shared_ptr<const PointCloud>& m) { cloud = m->width; };
  const std::vector<ros::Subscriber> subscribers{
      handle.subscribe<StringMessage>("/dkp_slam/state", 100, on_state),
      handle.subscribe<PoseMessage>("/dkp_slam/pose", 100, on_pose),
      handle.subscribe<TransformMessage>("/tf", 100, on_tf),
      handle.subscribe<PathMessage>("/dkp_slam/path", 10, on_path),
      handle.subscribe<PointCloud>("/dkp_slam/landmarks", 10, on_landmarks),
      handle.subscribe<PointCloud>("/dkp_slam/cloud", 10, on_cloud)};
  auto info = handle.advertise<CameraInfo>("/rgb/camera_info", 100);
  auto colour = handle.advertise<Image>("/rgb/image", 100);
  auto depth = handle.advertise<Image>("/depth/image", 100);
  // In both directions: what the node says before somebody listens is lost.
  ASSERT_TRUE(wait_until([&] {
    return info.getNumSubscribers() > 0 && colour.getNumSubscribers() > 0 &&
           depth.getNumSubscribers() > 0 &&
           std::all_of(subscribers.begin(), subscribers.end(),
                       [](const ros::Subscriber& s) { return s.getNumPublishers() > 0; });
  })) << log();

  const rosbag::Bag recorded(bag());
  rosbag::View view(recorded);
  const auto begin = std::chrono::steady_clock::now();
  for (const rosbag::MessageInstance& message : view) {
    const double after = (message.getTime() - view.getBeginTime()).toSec();
    std::this_thread::sleep_until(begin + std::chrono::duration<double>(after));
    if (const auto m = message.instantiate<CameraInfo>()) info.publish(*m);
    if (const auto m = message.instantiate<Image>()) {
      (message.getTopic() == "/rgb/image" ? colour : depth).publish(*m);
    }
    ros::getGlobalCallbackQueue()->callAvailable();
  }
  EXPECT_TRUE(wait_until([&] { return states.size() >= frame_count; })) << log();
  ASSERT_EQ(states.size(), std::size_t{frame_count}) << ::testing::PrintToString(states);
  EXPECT_THAT(states.back(), HasSubstr("\"state\": \"tracking\", \"localised\": true"));
  ASSERT_TRUE(wait_until([&] { return poses.size() >= frame_count; }));
  EXPECT_TRUE(wait_until([&] { return transforms >= frame_count; }));
  // To the right is -y in ROS.
  const auto& last = poses.back();
  EXPECT_EQ(last.header.frame_id, "map");
  const double moved = WallSequence::step * (frame_count - 1) * WallSequence::depth / 500.0;
  EXPECT_NEAR(last.pose.pose.position.y, -moved, 0.02);
  EXPECT_NEAR(last.pose.pose.position.x, 0.0, 0.02);
  EXPECT_GT(last.pose.covariance[0], 0.0);
  EXPECT_LT(last.pose.covariance[0], 0.01);
  EXPECT_TRUE(wait_until([&] { return path > 0 && landmarks > 50 && cloud > 100; }))
      << path << ' ' << landmarks << ' ' << cloud << log();
  EXPECT_EQ(started->end(), 0);
  EXPECT_THAT(log(), HasSubstr("20 frames, 20 answered, 0 dropped"));
}

}  // namespace
}  // namespace dkp_slam::ros1
