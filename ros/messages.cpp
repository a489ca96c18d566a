#include "ros/messages.h"

#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <sensor_msgs/PointField.h>

namespace dkp_slam::ros1 {
namespace {

using Pose = geometry_msgs::Pose_<Allocator<void>>;
using PoseStamped = geometry_msgs::PoseStamped_<Allocator<void>>;
using TransformStamped = geometry_msgs::TransformStamped_<Allocator<void>>;
using Field = sensor_msgs::PointField_<Allocator<void>>;

Pose message_of(const Se3& pose) {
  Pose message;
  message.position.x = pose.translation.x();
  message.position.y = pose.translation.y();
  message.position.z = pose.translation.z();
  message.orientation.w = pose.rotation.w();
  message.orientation.x = pose.rotation.x();
  message.orientation.y = pose.rotation.y();
  message.orientation.z = pose.rotation.z();
  return message;
}

/// A cloud of so many points with these float fields, zeros yet.
PointCloud empty_cloud(std::size_t points, const std::vector<const char*>& fields,
                       const Header& header) {
  PointCloud cloud;
  cloud.header = header;
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(points);
  for (const char* name : fields) {
    Field field;
    field.name = name;
    field.offset = static_cast<std::uint32_t>(cloud.fields.size() * sizeof(float));
    field.datatype = Field::FLOAT32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.point_step = static_cast<std::uint32_t>(fields.size() * sizeof(float));
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.is_dense = 1;
  cloud.data.resize(cloud.row_step);
  return cloud;
}

void put(PointCloud& cloud, std::size_t point, const Eigen::Vector3f& world,
         const Se3& map_from_world) {
  const Eigen::Vector3f at = (map_from_world * world.cast<double>()).cast<float>();
  std::memcpy(&cloud.data[point * cloud.point_step], at.data(), sizeof(float) * 3);
}

}  // namespace

Se3 ros_from_world() {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {Eigen::Quaterniond(axes), Eigen::Vector3d::Zero()};
}

PoseMessage pose_message(const FrameResult& result, const MapFrame& map) {
  PoseMessage message;
  message.header = map.header;
  const Se3 pose = map.from_world * result.world_from_camera;
  message.pose.pose = message_of(pose);
  // Ours is along the camera's axes.
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = pose.rotation.toRotationMatrix();
  Eigen::Matrix<double, 6, 6> covariance = turn * result.quality.covariance * turn.transpose();
  if (!covariance.allFinite()) covariance = result.quality.covariance;  // unknown all the same
  for (int i = 0; i < 36; ++i) message.pose.covariance[i] = covariance(i / 6, i % 6);
  return message;
}

TransformMessage transform_message(const FrameResult& result, const MapFrame& map,
                                   const std::string& child, const Se3& camera_from_child) {
  const Pose pose = message_of(map.from_world * result.world_from_camera * camera_from_child);
  TransformStamped transform;
  transform.header = map.header;
  transform.child_frame_id = child;
  transform.transform.translation.x = pose.position.x;
  transform.transform.translation.y = pose.position.y;
  transform.transform.translation.z = pose.position.z;
  transform.transform.rotation = pose.orientation;
  TransformMessage message;
  message.transforms.push_back(transform);
  return message;
}

PathMessage path_message(const Trajectory& path, const MapFrame& map) {
  PathMessage message;
  message.header = map.header;
  for (const StampedPose& pose : path) {
    PoseStamped stamped;
    stamped.header = map.header;
    stamped.header.stamp = ros::Time(pose.timestamp);
    stamped.pose = message_of(map.from_world * pose.world_from_camera);
    message.poses.push_back(stamped);
  }
  return message;
}

PointCloud cloud_message(const std::vector<Eigen::Vector3f>& points, const MapFrame& map) {
  PointCloud cloud = empty_cloud(points.size(), {"x", "y", "z"}, map.header);
  for (std::size_t i = 0; i < points.size(); ++i) put(cloud, i, points[i], map.from_world);
  return cloud;
}

PointCloud cloud_message(const SurfaceMesh& mesh, const MapFrame& map) {
  PointCloud cloud = empty_cloud(mesh.vertices.size(), {"x", "y", "z", "rgb"}, map.header);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    put(cloud, i, mesh.vertices[i], map.from_world);
    const auto& c = mesh.colours[i];
    // As PCL and RViz have it: a float whose bits are 0x00RRGGBB.
    const std::uint32_t rgb = std::uint32_t{c[0]} << 16U | std::uint32_t{c[1]} << 8U | c[2];
    std::memcpy(&cloud.data[i * cloud.point_step + 3 * sizeof(float)], &rgb, sizeof(rgb));
  }
  return cloud;
}

OccupancyGridMessage grid_message(const OccupancyGrid& grid, const MapFrame& map) {
  constexpr std::int8_t occupied = 100, free = 0, unknown = -1;
  OccupancyGridMessage message;
  message.header = map.header;
  message.info.map_load_time = map.header.stamp;
  message.info.resolution = static_cast<float>(grid.resolution);
  message.info.width = static_cast<std::uint32_t>(grid.cells.cols);
  message.info.height = static_cast<std::uint32_t>(grid.cells.rows);
  const Se3 corner(Eigen::Quaterniond::Identity(), {grid.origin.x(), grid.origin.y(), 0.0});
  message.info.origin = message_of(map.from_world * grid.level_from_world.inverse() * corner);
  for (int y = grid.cells.rows - 1; y >= 0; --y) {  // a message begins at the smallest y
    for (int x = 0; x < grid.cells.cols; ++x) {
      const auto cell = static_cast<GridCell>(grid.cells.at<std::uint8_t>(y, x));
      message.data.push_back(cell == GridCell::occupied ? occupied
                             : cell == GridCell::free   ? free
                                                        : unknown);
    }
  }
  return message;
}

Se3 pose_of(const Transform& transform) {
  const auto& r = transform.rotation;
  const auto& t = transform.translation;
  return {Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized(), {t.x, t.y, t.z}};
}

StringMessage state_message(const FrameResult& result) {
  const char* state = result.state == TrackingState::tracking ? "tracking"
                      : result.state == TrackingState::lost   ? "lost"
                                                              : "not_initialized";
  StringMessage message;
  message.data = fmt::format(
      R"({{"stamp": {:.6f}, "state": "{}", "localised": {}, "map": {}, "landmarks": {}, )"
      R"("removed_features": {}, "people_share": {:.3f}, "keyframes": {}, "frame_ms": {:.1f}}})",
      result.timestamp, state, result.localised, result.map, result.tracked_landmarks,
      result.removed_features, result.quality.people_share, result.map_keyframes, result.frame_ms);
  return message;
}

}  // namespace dkp_slam::ros1
