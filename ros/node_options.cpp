#include "ros/node_options.h"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <ros/node_handle.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include "dkp_slam/config/yaml/option_file.h"
#include "dkp_slam/error.h"

namespace dkp_slam::ros1 {
namespace {

using Parameters = std::map<std::string, std::string>;  // "tracking.local_keyframes" -> "60"

std::string text_of(const std::string& name, XmlRpc::XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value) ? "true" : "false";
    case XmlRpc::XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return fmt::format("{}", static_cast<double>(value));
    case XmlRpc::XmlRpcValue::TypeString:
      return static_cast<std::string>(value);
    default:
      throw Error(fmt::format("~{}: is no single value", name));
  }
}

/// All private parameters that are set.
Parameters private_parameters() {
  const std::string prefix = ros::this_node::getName() + "/";
  ros::NodeHandle node;
  std::vector<std::string> names;
  node.getParamNames(names);
  Parameters parameters;
  for (const std::string& name : names) {
    if (!name.starts_with(prefix)) continue;
    std::string own = name.substr(prefix.size());
    XmlRpc::XmlRpcValue value;
    if (!node.getParam(name, value)) continue;
    const std::string text = text_of(own, value);
    std::replace(own.begin(), own.end(), '/', '.');
    parameters[own] = text;
  }
  return parameters;
}

}  // namespace

void NodeOptions::describe(OptionList& list) {
  list.add("camera", camera, "camera file; empty: the camera_info that comes");
  list.add("config", config, "file of the configuration, before the other parameters");
  list.add("compressed", compressed, "take rgb/image/compressed and depth/image/compressedDepth");
  list.add("max_difference", max_difference, above(0.0), "seconds",
           "between colour and depth that belong together");
  list.add("queue", queue, at_least(1), "", "messages that may wait for the node");
  list.add("map_frame", map_frame, "tf frame of the world");
  list.add("camera_frame", camera_frame, "tf frame of the camera; empty: that of the images");
  list.add("base_frame", base_frame,
           "tf frame of the robot, to which /tf_static leads from the camera; empty: none");
  list.add("map_file", map_file,
           "to go on with and keep up to date; with localize_only to find the camera in");
  list.add("publish_tf", publish_tf,
           "whether map_frame to base_frame, or to camera_frame, goes to tf");
  list.add("map_interval", map_interval, above(0.0), "seconds", "from one path and landmarks on");
  list.add("dense_interval", dense_interval, above(0.0), "seconds",
           "from one cloud and grid on, at least");
  list.add("dense_keyframes", dense_keyframes, at_least(2), "", "keyframes whose images are kept");
  list.add("voxel", voxel, between(0.005, 0.2), "metres", "of the dense cloud");
  list.add("range", range, between(0.5, 100.0), "metres", "depth beyond it is not fused");
  list.add("cell", cell, between(0.01, 1.0), "metres", "of the grid");
  list.add("low", low, any_number(), "metres", "above the floor: begin of the grid's band");
  list.add("high", high, any_number(), "metres", "above the floor: end of the grid's band");
  list.order("low", "high");
}

NodeParameters read_parameters() {
  NodeParameters parameters;
  parameters.slam.realtime = true;
  const Parameters given = private_parameters();
  OptionList slam = OptionList::of(parameters.slam);
  if (const auto file = given.find("config"); file != given.end() && !file->second.empty()) {
    read_option_file(file->second, slam);
  }
  OptionList node = OptionList::of(parameters.node);
  for (const auto& [name, text] : given) {
    Option* option = node.find(name);
    if (!option) option = slam.find(name);
    if (!option) {
      throw Error(fmt::format("~{}: is no parameter; the nearest of the configuration is {}", name,
                              slam.nearest(name)));
    }
    // rosparam makes 1 of 1.0 and an int of a number that is to be none: the text is the same.
    option->assign(text);
  }
  node.check();
  slam.check();
  if (parameters.slam.localize_only && parameters.node.map_file.empty()) {
    throw Error("~localize_only: needs a map to find the camera in; give its file with ~map_file");
  }
  return parameters;
}

}  // namespace dkp_slam::ros1
