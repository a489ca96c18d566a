#pragma once

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <boost/function.hpp>

#include "dkp_slam/map_file/test_folder.h"
#include "ros/messages.h"
#include "tests/support/file_text.h"

namespace dkp_slam::ros1::testing {

using dkp_slam::testing::content;

/// A process that ends with it.
class Started {
 public:
  Started(std::vector<std::string> words, const std::filesystem::path& log) {
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

inline bool wait_until(const std::function<bool()>& condition) {
  constexpr int most = 12000;  // two minutes: under a sanitizer everything takes ten times as long
  for (int i = 0; i < most && !condition(); ++i) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  }
  return condition();
}

/// A TCP port that nobody has: below those that the kernel gives to whoever connects (from 32768
/// on), one of which a neighbouring test may hold, and another for each process. Zero when there
/// is none.
inline int free_port() {
  constexpr int first = 20000, count = 12000;
  for (int i = 0; i < count; ++i) {
    const int port = first + (::getpid() + i) % count;
    const int one = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_ANY);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    const bool is_free =
        ::bind(one, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    ::close(one);
    if (is_free) return port;
  }
  return 0;
}

/// A test with a roscore of its own, on which it listens, and nodes that it starts.
class RosNode : public dkp_slam::testing::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    // Nobody else's master, and nothing in the user's home.
    const std::string port = std::to_string(free_port());
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
  /// Calls `take` with each message of a topic.
  template <class Message>
  void listen(const std::string& topic, const std::function<void(const Message&)>& take) {
    const boost::function<void(const boost::shared_ptr<const Message>&)> call =
        [take](const boost::shared_ptr<const Message>& m) { take(*m); };
    constexpr int queue = 1000;
    subscribers_.push_back(handle().subscribe<Message>(topic, queue, call));
  }
  ros::NodeHandle& handle() {
    if (!handle_) handle_ = std::make_unique<ros::NodeHandle>();
    return *handle_;
  }
  /// Plays a bag of /rgb/camera_info, /rgb/image and /depth/image at its own pace, when the node
  /// listens and is listened to: what it says before is lost. False when it does not come.
  bool play(const std::string& bag) {
    auto info = handle().advertise<CameraInfo>("/rgb/camera_info", 1000);
    auto colour = handle().advertise<Image>("/rgb/image", 1000);
    auto depth = handle().advertise<Image>("/depth/image", 1000);
    const bool there = wait_until([&] {
      bool all = info.getNumSubscribers() > 0 && colour.getNumSubscribers() > 0 &&
                 depth.getNumSubscribers() > 0;
      for (const ros::Subscriber& s : subscribers_) all = all && s.getNumPublishers() > 0;
      return all;
    });
    if (!there) return false;
    const rosbag::Bag recorded(bag);
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
    // Kept until the test ends: who has just read the last message may not have taken it yet.
    publishers_ = {info, colour, depth};
    return true;
  }

  std::unique_ptr<Started> core_;

 private:
  std::unique_ptr<ros::NodeHandle> handle_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::Publisher> publishers_;
};

}  // namespace dkp_slam::ros1::testing
