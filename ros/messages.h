#pragma once

#include <string>
#include <vector>

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>
#include <Eigen/Core>

#include "dkp_slam/dense/occupancy_grid.h"
#include "dkp_slam/dense/surface_mesh.h"
#include "dkp_slam/geometry/stamped_pose.h"
#include "dkp_slam/sensor/bag/ros_messages.h"
#include "dkp_slam/system/frame_result.h"

namespace dkp_slam::ros1 {

using Header = std_msgs::Header_<Allocator<void>>;
using OccupancyGridMessage = nav_msgs::OccupancyGrid_<Allocator<void>>;
using PathMessage = nav_msgs::Path_<Allocator<void>>;
using PointCloud = sensor_msgs::PointCloud2_<Allocator<void>>;
using PoseMessage = geometry_msgs::PoseWithCovarianceStamped_<Allocator<void>>;
using StringMessage = std_msgs::String_<Allocator<void>>;
using TransformMessage = tf2_msgs::TFMessage_<Allocator<void>>;

/// From the system's world, the first camera's frame (x right, y down, z ahead), to ROS's (x ahead,
/// y left, z up), which stands upright if the first camera did.
Se3 ros_from_world();

/// A map of the atlas as others are told of it.
struct MapFrame {
  Header header;
  Se3 from_world = ros_from_world();  ///< to the header's frame
};

/// Of the camera's optical frame; the covariance about the fixed axes of the map's frame.
PoseMessage pose_message(const FrameResult& result, const MapFrame& map);
/// Where `child` is, which lies at `camera_from_child`.
TransformMessage transform_message(const FrameResult& result, const MapFrame& map,
                                   const std::string& child, const Se3& camera_from_child);
PathMessage path_message(const Trajectory& path, const MapFrame& map);
PointCloud cloud_message(const std::vector<Eigen::Vector3f>& points, const MapFrame& map);
/// With colours.
PointCloud cloud_message(const SurfaceMesh& mesh, const MapFrame& map);
OccupancyGridMessage grid_message(const OccupancyGrid& grid, const MapFrame& map);
/// As the library has it.
Se3 pose_of(const Transform& transform);
/// One line of JSON: {"stamp": ..., "state": "tracking", ...}.
StringMessage state_message(const FrameResult& result);

}  // namespace dkp_slam::ros1
