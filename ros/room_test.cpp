// The node on a robot in a room that is known: tf of its base, dense cloud and occupancy grid, and
// a map file that is kept and found again.
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <geometry_msgs/TransformStamped.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/dense/test_views.h"
#include "dkp_slam/sensor/bag/test_bag.h"
#include "ros/test_node.h"

namespace dkp_slam::ros1 {
namespace {

using dkp_slam::testing::TestBag;
using testing::content;
using ::testing::HasSubstr;
using testing::wait_until;

constexpr int room_frames = 90;
constexpr double pi = 3.14159265358979323846;
/// Metres: x ahead of where the robot begins, y to its left, z from the floor.
const Eigen::AlignedBox3d room(Eigen::Vector3d(-1.5, -2.0, 0.0), Eigen::Vector3d(2.5, 2.0, 2.5));
const Eigen::AlignedBox3d pillar(Eigen::Vector3d(1.2, 0.5, 0.0), Eigen::Vector3d(1.6, 0.9, 1.0));

Camera small_camera() {
  Camera camera = dkp_slam::testing::small_camera();
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 260.0;
  camera.cx = 159.5;
  camera.cy = 119.5;
  return camera;
}

/// The camera on its mast, looking a little down.
Se3 base_from_camera() {
  const double down = 15.0 * pi / 180.0;
  const Eigen::AngleAxisd pitch(down, Eigen::Vector3d::UnitY());
  return {pitch * ros_from_world().rotation, {0.1, 0.0, 1.2}};
}

/// The robot drives to and fro while it looks about.
Se3 room_from_base(int i) {
  const double phase = 2.0 * pi * i / room_frames;
  const Eigen::AngleAxisd yaw(0.6 * std::sin(phase), Eigen::Vector3d::UnitZ());
  return {Eigen::Quaterniond(yaw), {0.2 - 0.2 * std::cos(phase), 0.0, 0.0}};
}

/// Length of a ray from within the room to its walls.
double to_wall(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  double out = INFINITY;
  for (int i = 0; i < 3; ++i) {
    const double wall = ray[i] > 0.0 ? room.max()[i] : room.min()[i];
    if (ray[i] != 0.0) out = std::min(out, (wall - origin[i]) / ray[i]);
  }
  return out;
}

/// Cubes of 7 cm, each of its own colour, none of whose sides lies in a wall.
cv::Vec3b paint(const Eigen::Vector3d& point) {
  const Eigen::Vector3i cell = ((point.array() + 0.013) / 0.07).floor().cast<int>();
  std::uint32_t hash = 2166136261U;
  for (const int c : cell) hash = (hash ^ static_cast<std::uint32_t>(c + 1000)) * 16777619U;
  hash ^= hash >> 15U;
  return {static_cast<uchar>(hash), static_cast<uchar>(hash >> 8U),
          static_cast<uchar>(hash >> 16U)};
}

void write_bag(const std::string& file) {
  const Camera camera = small_camera();
  const auto obstacle = dkp_slam::testing::box(pillar);
  TestBag bag(file);
  for (int i = 0; i < room_frames; ++i) {
    const Se3 pose = room_from_base(i) * base_from_camera();
    cv::Mat colour(camera.height, camera.width, CV_8UC3), depth(colour.size(), CV_16UC1);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3d ray = pose.rotation * camera.unproject({double(u), double(v)}, 1.0);
        const double metres =
            std::min(to_wall(pose.translation, ray), obstacle(pose.translation, ray));
        colour.at<cv::Vec3b>(v, u) = paint(pose.translation + metres * ray);
        depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(std::lround(metres * 1000.0));
      }
    }
    const double t = 100.0 + i / 30.0;
    bag.info("/rgb/camera_info", t, colour.size(), camera.fx);
    bag.image("/rgb/image", t, colour, "bgr8");
    bag.image("/depth/image", t, depth, "16UC1");
  }
}

/// How far a point is from the nearest wall, floor or side of the pillar.
double from_surface(const Eigen::Vector3d& p) {
  double nearest = (room.max() - p).cwiseAbs().minCoeff();
  nearest = std::min(nearest, (p - room.min()).cwiseAbs().minCoeff());
  const Eigen::Vector3d outside = (pillar.min() - p).cwiseMax(p - pillar.max());
  const double to_pillar =
      outside.maxCoeff() > 0.0 ? outside.cwiseMax(0.0).norm() : -outside.maxCoeff();
  return std::min(nearest, to_pillar);
}

template <class Pose>
Se3 se3_of(const Pose& p) {
  return {Eigen::Quaterniond(p.orientation.w, p.orientation.x, p.orientation.y, p.orientation.z),
          {p.position.x, p.position.y, p.position.z}};
}

/// Value of the cell at a point of the floor, -1 outside.
int cell_at(const OccupancyGridMessage& grid, double x, double y) {
  const Eigen::Vector3d p = se3_of(grid.info.origin).inverse() * Eigen::Vector3d(x, y, 0.0);
  const auto column = static_cast<int>(std::floor(p.x() / grid.info.resolution));
  const auto row = static_cast<int>(std::floor(p.y() / grid.info.resolution));
  const auto width = static_cast<int>(grid.info.width), height = static_cast<int>(grid.info.height);
  if (column < 0 || row < 0 || column >= width || row >= height) return -1;
  return grid.data[static_cast<std::size_t>(row * width + column)];
}

/// Whether something stands within a cell of a point.
bool occupied_about(const OccupancyGridMessage& grid, double x, double y) {
  const double step = grid.info.resolution;
  for (const double dx : {-step, 0.0, step}) {
    for (const double dy : {-step, 0.0, step}) {
      if (cell_at(grid, x + dx, y + dy) == 100) return true;
    }
  }
  return false;
}

class RoomNode : public testing::RosNode {
 protected:
  void SetUp() override {
    RosNode::SetUp();
    // Whoever announces a topic without a master waits for one, for ever.
    if (HasFatalFailure()) return;
    write_bag(bag());
    listen<StringMessage>("/dkp_slam/state", [&](const auto& m) { states_.push_back(m.data); });
    listen<PoseMessage>("/dkp_slam/pose", [&](const auto& m) { poses_.push_back(m); });
    listen<PointCloud>("/dkp_slam/cloud", [&](const auto& m) { cloud_ = m; });
    listen<OccupancyGridMessage>("/dkp_slam/grid", [&](const auto& m) { grid_ = m; });
    listen<TransformMessage>("/tf", [&](const auto& m) { transforms_.push_back(m.transforms[0]); });
    // As a robot's description tells it, by way of the mast.
    mast_ = handle().advertise<TransformMessage>("/tf_static", 1, true);
    TransformMessage message;
    message.transforms.push_back(transform(
        "base", "mast", {Eigen::Quaterniond::Identity(), base_from_camera().translation}));
    message.transforms.push_back(
        transform("mast", "eye", {base_from_camera().rotation, Eigen::Vector3d::Zero()}));
    mast_.publish(message);
  }
  std::string bag() const { return folder_ / "room.bag"; }
  std::string map_file() const { return folder_ / "room.map"; }

  using Stamped = geometry_msgs::TransformStamped_<Allocator<void>>;
  static Stamped transform(const std::string& parent, const std::string& child, const Se3& pose) {
    Stamped message;
    message.header.frame_id = parent;
    message.child_frame_id = child;
    message.transform.translation.x = pose.translation.x();
    message.transform.translation.y = pose.translation.y();
    message.transform.translation.z = pose.translation.z();
    message.transform.rotation.w = pose.rotation.w();
    message.transform.rotation.x = pose.rotation.x();
    message.transform.rotation.y = pose.rotation.y();
    message.transform.rotation.z = pose.rotation.z();
    return message;
  }
  /// Plays the bag into a node and waits for all answers and what `more` wants.
  void play_into_node(std::vector<std::string> parameters, const std::function<bool()>& more) {
    for (const char* p : {"_mode:=off", "_realtime:=false", "_queue:=200", "_map_interval:=0.1",
                          "_dense_interval:=0.3", "_camera_frame:=eye", "_base_frame:=base"}) {
      parameters.emplace_back(p);
    }
    states_.clear();
    poses_.clear();
    transforms_.clear();
    const auto started = node(parameters);
    ASSERT_TRUE(play(bag())) << log();
    EXPECT_TRUE(wait_until([&] {
      return poses_.size() >= room_frames && transforms_.size() >= room_frames && more();
    })) << states_.size()
        << ' ' << poses_.size() << log();
    EXPECT_EQ(started->end(), 0) << log();
    EXPECT_THAT(log(), HasSubstr("90 frames, 90 answered, 0 dropped"));
  }
  void expect_true_way() const {
    ASSERT_EQ(poses_.size(), std::size_t{room_frames});
    ASSERT_EQ(transforms_.size(), std::size_t{room_frames});
    for (int i = 0; i < room_frames; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const Se3 camera = se3_of(poses_[k].pose.pose);
      const Se3 true_camera = room_from_base(i) * base_from_camera();
      EXPECT_LT((camera.translation - true_camera.translation).norm(), 0.02) << i;
      EXPECT_EQ(transforms_[k].header.frame_id, "map");
      EXPECT_EQ(transforms_[k].child_frame_id, "base");
      const Se3 base = pose_of(transforms_[k].transform);
      EXPECT_LT((base.translation - room_from_base(i).translation).norm(), 0.03) << i;
      EXPECT_LT((base.inverse() * room_from_base(i)).angle(), 0.02) << i;
    }
  }
  void expect_true_cloud() const {
    EXPECT_EQ(cloud_->header.frame_id, "map");
    ASSERT_EQ(cloud_->fields.size(), 4U);
    EXPECT_EQ(cloud_->fields[3].name, "rgb");
    int near = 0;
    for (std::uint32_t i = 0; i < cloud_->width; ++i) {
      Eigen::Vector3f point;
      std::memcpy(point.data(), &cloud_->data[i * cloud_->point_step], sizeof(float) * 3);
      near += from_surface(point.cast<double>()) < 0.03 ? 1 : 0;
    }
    EXPECT_GT(cloud_->width, 3000U);
    EXPECT_GT(near, 0.97 * cloud_->width);
  }
  void expect_true_grid() const {
    const OccupancyGridMessage& grid = *grid_;
    EXPECT_EQ(grid.header.frame_id, "map");
    EXPECT_FLOAT_EQ(grid.info.resolution, 0.05F);
    ASSERT_EQ(grid.data.size(), std::size_t{grid.info.width} * grid.info.height);
    // Upright, and on the floor below the base.
    const Se3 origin = se3_of(grid.info.origin);
    EXPECT_LT((origin.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm(), 0.02);
    EXPECT_NEAR(origin.translation.z(), 0.0, 0.05);
    int walls = 0;
    for (int i = 0; i < 40; ++i) walls += occupied_about(grid, 2.5, -0.9 + 0.045 * i) ? 1 : 0;
    EXPECT_GE(walls, 38);
    for (const double y : {0.55, 0.7, 0.85}) EXPECT_TRUE(occupied_about(grid, 1.2, y)) << y;
    for (const double x : {0.6, 0.8, 1.0}) {
      for (const double y : {-0.3, 0.0, 0.3}) EXPECT_EQ(cell_at(grid, x, y), 0) << x << ' ' << y;
    }
    EXPECT_EQ(cell_at(grid, 1.8, -0.5), 0);
    for (const double y : {-0.5, 0.0, 0.5}) EXPECT_EQ(cell_at(grid, 2.7, y), -1) << y;
    EXPECT_EQ(cell_at(grid, -1.0, 0.0), -1);  // behind its back
  }

  ros::Publisher mast_;
  std::vector<std::string> states_;
  std::vector<PoseMessage> poses_;
  std::vector<Stamped> transforms_;
  std::optional<PointCloud> cloud_;
  std::optional<OccupancyGridMessage> grid_;
};

TEST_F(RoomNode, TellsWhereTheBaseIsAndWhatStandsInTheRoomAndKeepsItsMap) {
  play_into_node({"_map_file:=" + map_file()},
                 [&] { return cloud_ && cloud_->width > 3000 && grid_; });
  expect_true_way();
  ASSERT_TRUE(cloud_ && grid_);
  expect_true_cloud();
  expect_true_grid();
  // Another day: where the map says, from the first frame on, and the file stays as it is.
  const std::string kept = content(map_file());
  ASSERT_GT(kept.size(), 10000U);
  play_into_node({"_map_file:=" + map_file(), "_localize_only:=true"}, [] { return true; });
  expect_true_way();
  EXPECT_THAT(states_.front(), HasSubstr("\"localised\": true"));
  EXPECT_TRUE(content(map_file()) == kept);
}

}  // namespace
}  // namespace dkp_slam::ros1
