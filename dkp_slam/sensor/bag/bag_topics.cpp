#include "dkp_slam/sensor/bag/bag_topics.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

constexpr const char* image_type = "sensor_msgs/Image";
constexpr const char* compressed_type = "sensor_msgs/CompressedImage";
constexpr const char* info_type = "sensor_msgs/CameraInfo";

bool is_image(const BagTopic& topic) {
  return topic.messages > 0 && (topic.type == image_type || topic.type == compressed_type);
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

std::string parent_of(const std::string& topic) { return topic.substr(0, topic.rfind('/')); }

/// Below 0: is not.
int likeness_to_depth(const BagTopic& topic) {
  const std::string name = lower(topic.name);
  if (!has(name, "depth") || has(name, "confidence") || has(name, "mask")) return -1;
  int points = 0;
  if (has(name, "aligned") || has(name, "registered")) points += 4;
  if (topic.type == image_type) points += 2;
  // JPEG and video of depth are for the eye.
  if (topic.type == compressed_type && !has(name, "compresseddepth")) points -= 3;
  return std::max(points, -1);
}

int likeness_to_colour(const BagTopic& topic) {
  const std::string name = lower(topic.name);
  for (const char* other : {"depth", "infra", "/ir/", "disparity", "mask", "confidence"}) {
    if (has(name, other)) return -1;
  }
  int points = 0;
  if (has(name, "color") || has(name, "colour") || has(name, "rgb")) points += 4;
  if (topic.type == image_type) points += 2;
  return points;
}

template <class Likeness>
std::string most_like(const std::vector<BagTopic>& topics, const Likeness& likeness) {
  const BagTopic* best = nullptr;
  for (const BagTopic& topic : topics) {
    if (!is_image(topic) || likeness(topic) < 0) continue;
    if (!best || likeness(topic) > likeness(*best) ||
        (likeness(topic) == likeness(*best) && topic.name < best->name)) {
      best = &topic;
    }
  }
  return best ? best->name : "";
}

std::string images_among(const std::vector<BagTopic>& topics) {
  std::string names;
  for (const BagTopic& topic : topics) {
    if (is_image(topic)) names += (names.empty() ? "" : ", ") + topic.name;
  }
  return names.empty() ? "it has no images at all" : "its images: " + names;
}

/// The topic of this name and type, or nothing.
std::string there(const std::vector<BagTopic>& topics, const std::string& name, const char* type) {
  const bool found = std::any_of(topics.begin(), topics.end(), [&](const BagTopic& topic) {
    return topic.name == name && topic.type == type && topic.messages > 0;
  });
  return found ? name : "";
}

/// "/camera/rgb/image_color" -> "/camera/rgb/camera_info"; also of a compressed transport of it,
/// and in the layout of a RealSense recording.
std::string info_of(const std::vector<BagTopic>& topics, const std::string& images) {
  std::string parent = parent_of(images);
  for (int level = 0; level < 2 && !parent.empty(); ++level, parent = parent_of(parent)) {
    for (const char* name : {"/camera_info", "/info/camera_info"}) {
      if (auto info = there(topics, parent + name, info_type); !info.empty()) return info;
    }
  }
  return "";
}

/// ".../Depth_0/image/data" -> ".../Depth_0/tf/0".
std::string pose_of(const std::vector<BagTopic>& topics, const std::string& images) {
  return there(topics, parent_of(parent_of(images)) + "/tf/0", "geometry_msgs/Transform");
}

void check_wanted(const std::vector<BagTopic>& topics, const std::string& name) {
  const bool found = std::any_of(topics.begin(), topics.end(), [&](const BagTopic& topic) {
    return topic.name == name && is_image(topic);
  });
  if (!found) {
    throw Error(fmt::format("has no images in {} (--topics); {}", name, images_among(topics)));
  }
}

}  // namespace

CameraTopics choose_topics(const std::vector<BagTopic>& topics, const CameraTopics& wanted) {
  CameraTopics chosen = wanted;
  for (const std::string* name : {&chosen.colour, &chosen.depth}) {
    if (!name->empty()) check_wanted(topics, *name);
  }
  if (chosen.colour.empty()) chosen.colour = most_like(topics, likeness_to_colour);
  if (chosen.depth.empty()) chosen.depth = most_like(topics, likeness_to_depth);
  for (const auto& [name, kind] : {std::pair(&chosen.colour, "colour"), {&chosen.depth, "depth"}}) {
    if (!name->empty()) continue;
    throw Error(fmt::format("has no {} images; {}; name others with --topics COLOUR,DEPTH", kind,
                            images_among(topics)));
  }
  if (chosen.colour_info.empty()) {
    chosen.colour_info = info_of(topics, chosen.colour);
  } else if (there(topics, chosen.colour_info, info_type).empty()) {
    throw Error(fmt::format("has no {} in {} (--topics)", info_type, chosen.colour_info));
  }
  chosen.depth_info = info_of(topics, chosen.depth);
  chosen.colour_pose = pose_of(topics, chosen.colour);
  chosen.depth_pose = pose_of(topics, chosen.depth);
  chosen.depth_unit =
      there(topics, parent_of(parent_of(parent_of(chosen.depth))) + "/option/Depth_Units/value",
            "std_msgs/Float32");
  return chosen;
}

CameraTopics parse_topics(const std::string& text) {
  CameraTopics topics;
  const auto first = text.find(',');
  const auto second = first == std::string::npos ? first : text.find(',', first + 1);
  topics.colour = text.substr(0, first);
  if (first != std::string::npos) topics.depth = text.substr(first + 1, second - first - 1);
  if (second != std::string::npos) topics.colour_info = text.substr(second + 1);
  if (topics.colour.empty() || topics.depth.empty() ||
      topics.colour_info.find(',') != std::string::npos ||
      (second != std::string::npos && topics.colour_info.empty())) {
    throw Error(fmt::format("--topics {}: must be COLOUR,DEPTH or COLOUR,DEPTH,CAMERA_INFO", text));
  }
  return topics;
}

bool is_rectified(const std::string& topic) { return has(lower(topic), "image_rect"); }

}  // namespace dkp_slam
