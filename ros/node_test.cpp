// The node, as a robot has it: a roscore of its own, a bag that is played in real time, and
// somebody who listens.
#include <filesystem>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ros/master.h>
#include <yaml-cpp/yaml.h>

#include "apps/test_sequence.h"
#include "dkp_slam/sensor/bag/test_bag.h"
#include "dkp_slam/sensor/tum_source.h"
#include "ros/test_node.h"

namespace dkp_slam::ros1 {
namespace {

using dkp_slam::testing::TestBag;
using dkp_slam::testing::WallSequence;
using testing::content;
using ::testing::HasSubstr;
using testing::wait_until;

constexpr int wall_frames = 20;

class WallNode : public testing::RosNode {
 protected:
  std::string bag() const { return folder_ / "wall.bag"; }
  void write_bag() const {
    const WallSequence sequence(folder_ / "sequence", wall_frames);
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
  /// Every display of the view for RViz that is shipped shows a topic of the running node, of the
  /// type that it draws, or what the launch file listens to; in the frame that the file tells.
  static void expect_rviz_shows_what_is_told() {
    const std::map<std::string, std::string> type_of{
        {"rviz/Map", "nav_msgs/OccupancyGrid"},
        {"rviz/PointCloud2", "sensor_msgs/PointCloud2"},
        {"rviz/Path", "nav_msgs/Path"},
        {"rviz/PoseWithCovariance", "geometry_msgs/PoseWithCovarianceStamped"}};
    ros::master::V_TopicInfo topics;
    ASSERT_TRUE(ros::master::getTopics(topics));
    std::map<std::string, std::string> told;
    for (const auto& topic : topics) told[topic.name] = topic.datatype;
    const auto launch = std::filesystem::path(DKP_SLAM_NODE).parent_path() / "launch";
    const YAML::Node view = YAML::LoadFile(launch / "rgbd.rviz")["Visualization Manager"];
    const std::string arguments = content(launch / "rgbd.launch");
    const auto default_of = [&](const std::string& name) {
      std::smatch found;
      const std::regex argument("<arg name=\"" + name + "\" default=\"([^\"]*)\"");
      return std::regex_search(arguments, found, argument) ? found[1].str() : "no " + name;
    };
    EXPECT_EQ(view["Global Options"]["Fixed Frame"].as<std::string>(), default_of("map_frame"));
    std::size_t shown = 0;
    for (const YAML::Node& display : view["Displays"]) {
      const auto kind = display["Class"].as<std::string>();
      if (kind == "rviz/Image") {
        EXPECT_EQ(display["Image Topic"].as<std::string>(), default_of("rgb"));
        continue;
      }
      const auto topic = display["Topic"].as<std::string>();
      ASSERT_EQ(told.count(topic), 1U) << topic;
      ASSERT_EQ(type_of.count(kind), 1U) << kind;
      EXPECT_EQ(told[topic], type_of.at(kind)) << topic;
      ++shown;
    }
    EXPECT_EQ(shown, 5U);
  }
  void expect_refused(const std::string& parameter, const std::string& value,
                      const std::string& told) {
    const auto wrong = node({"_" + parameter + ":=" + value});
    EXPECT_EQ(wrong->end(0), 1);
    EXPECT_THAT(log(), HasSubstr(told));
    handle().deleteParam("/dkp_slam/" + parameter);
  }
};

TEST_F(WallNode, AnswersEveryFrameOfABagAndSaysWhatIsWrong) {
  expect_refused("tracking/locl_keyframes", "60", "~tracking.locl_keyframes: is no parameter");
  EXPECT_THAT(log(), HasSubstr("tracking.local_keyframes"));
  expect_refused("localize_only", "true", "~localize_only: needs a map to find the camera in");
  expect_refused("camera", "nowhere.yaml", "nowhere.yaml");
  write_bag();
  // It waits for room instead of dropping what a busy machine has no time for.
  const auto started = node({"_mode:=off", "_realtime:=false", "_queue:=100", "_map_interval:=0.1",
                             "_dense_interval:=0.5", "_camera_frame:=eye"});
  std::vector<std::string> states;
  std::vector<PoseMessage> poses;
  int transforms = 0;
  std::size_t path = 0, landmarks = 0, cloud = 0;
  listen<StringMessage>("/dkp_slam/state", [&](const auto& m) { states.push_back(m.data); });
  listen<PoseMessage>("/dkp_slam/pose", [&](const auto& m) { poses.push_back(m); });
  listen<TransformMessage>("/tf", [&](const auto& m) {
    if (m.transforms.at(0).child_frame_id == "eye") ++transforms;
  });
  listen<PathMessage>("/dkp_slam/path", [&](const auto& m) { path = m.poses.size(); });
  listen<PointCloud>("/dkp_slam/landmarks", [&](const auto& m) { landmarks = m.width; });
  listen<PointCloud>("/dkp_slam/cloud", [&](const auto& m) { cloud = m.width; });
  ASSERT_TRUE(play(bag())) << log();
  EXPECT_TRUE(wait_until([&] { return states.size() >= wall_frames; })) << log();
  ASSERT_EQ(states.size(), std::size_t{wall_frames}) << ::testing::PrintToString(states);
  EXPECT_THAT(states.back(), HasSubstr("\"state\": \"tracking\", \"localised\": true"));
  ASSERT_TRUE(wait_until([&] { return poses.size() >= wall_frames; }));
  EXPECT_TRUE(wait_until([&] { return transforms >= wall_frames; }));
  // To the right is -y in ROS.
  const auto& last = poses.back();
  EXPECT_EQ(last.header.frame_id, "map");
  const double moved = WallSequence::step * (wall_frames - 1) * WallSequence::depth / 500.0;
  EXPECT_NEAR(last.pose.pose.position.y, -moved, 0.02);
  EXPECT_NEAR(last.pose.pose.position.x, 0.0, 0.02);
  EXPECT_GT(last.pose.covariance[0], 0.0);
  EXPECT_LT(last.pose.covariance[0], 0.01);
  EXPECT_TRUE(wait_until([&] { return path > 0 && landmarks > 50 && cloud > 100; }))
      << path << ' ' << landmarks << ' ' << cloud << log();
  expect_rviz_shows_what_is_told();
  EXPECT_EQ(started->end(), 0);
  EXPECT_THAT(log(), HasSubstr("20 frames, 20 answered, 0 dropped"));
}

}  // namespace
}  // namespace dkp_slam::ros1
