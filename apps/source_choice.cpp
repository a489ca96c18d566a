#include "apps/source_choice.h"

#include <filesystem>
#include <optional>
#include <utility>

#include <spdlog/spdlog.h>

#include "apps/camera_choice.h"
#include "apps/progress.h"
#include "dkp_slam/error.h"
#include "dkp_slam/sensor/bag/bag_source.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/kinect/kinect_source.h"
#include "dkp_slam/sensor/stream/stream_source.h"

namespace dkp_slam::apps {
namespace {

OpenedSource open_driver(const SourceChoice& choice) {
  OpenedSource opened;
  // A wrong camera file is said before anybody waits for a driver.
  if (!choice.camera.empty()) {
    opened.camera_name = choose_camera(choice.name, choice.camera);
    opened.camera = load_camera(opened.camera_name);
  }
  StreamOptions options;
  options.channel.stop = &interrupt_flag();
  options.reconnect = choice.reconnect;
  options.masks = choice.stream_masks;
  auto stream = open_stream(StreamAddress::parse(choice.name), options);
  if (choice.camera.empty()) {
    if (!stream->own_camera()) {
      throw Error(stream->description() +
                  ": the stream brings no camera file; give one with --camera");
    }
    opened.camera = *stream->own_camera();
    opened.camera_name = "of the stream";
  }
  stream->use_camera(opened.camera);
  opened.source = std::move(stream);
  return opened;
}

OpenedSource open_bag_file(const SourceChoice& choice) {
  OpenedSource opened;
  if (!choice.camera.empty()) {
    opened.camera_name = choose_camera(choice.name, choice.camera);
    opened.camera = load_camera(opened.camera_name);
  }
  BagOptions options;
  if (!choice.topics.empty()) options.topics = parse_topics(choice.topics);
  auto bag = open_bag(choice.name, options);
  if (choice.camera.empty()) {
    if (!bag->own_camera()) {
      throw Error(bag->description() +
                  ": has no camera_info of its colour images; give a camera file with --camera");
    }
    opened.camera = *bag->own_camera();
    opened.camera_name = opened.camera.name;
    spdlog::info("camera: {}", opened.camera_name);
  }
  bag->use_camera(opened.camera);
  opened.source = std::move(bag);
  return opened;
}

OpenedSource open_device(const SourceChoice& choice) {
  OpenedSource opened;
  opened.camera_name = choose_camera(choice.name, choice.camera.empty() ? "kinect" : choice.camera);
  if (choice.camera.empty()) spdlog::info("camera: {}", opened.camera_name);
  opened.camera = load_camera(opened.camera_name);
  KinectOptions options;
  options.number = kinect_number(choice.name);
  options.stop = &interrupt_flag();
  options.reconnect = choice.reconnect;
  auto kinect = open_kinect(options);
  kinect->use_camera(opened.camera);
  opened.source = std::move(kinect);
  return opened;
}

OpenedSource open_folder(const SourceChoice& choice) {
  OpenedSource opened;
  TumOptions images;
  images.masks = choice.masks;
  std::optional<Camera> own;
  if (choice.camera.empty() && !std::filesystem::exists(choice.name + "/camera.yaml")) {
    own = own_camera(choice.name);
  }
  if (own) {
    opened.camera = *own;
    opened.camera_name = own->name;
  } else {
    opened.camera_name = choose_camera(choice.name, choice.camera);
    opened.camera = load_camera(opened.camera_name);
  }
  if (choice.camera.empty()) spdlog::info("camera: {}", opened.camera_name);
  opened.source = open_image_folder(choice.name, opened.camera, images, choice.frame_rate);
  return opened;
}

}  // namespace

bool is_stream(const std::string& name) { return StreamAddress::looks_like(name); }

bool is_socket(const std::string& name) { return is_stream(name) && name != "-"; }

bool is_live(const std::string& name) { return is_socket(name) || is_kinect(name); }

bool is_bag_file(const std::string& name) {
  const std::filesystem::path path = name;
  std::error_code ignored;
  return is_bag(name) ||
         (path.extension() == ".bag" && !std::filesystem::is_directory(path, ignored));
}

OpenedSource open_source(const SourceChoice& choice) {
  if (is_stream(choice.name)) return open_driver(choice);
  if (is_kinect(choice.name)) return open_device(choice);
  if (is_bag_file(choice.name)) return open_bag_file(choice);
  if (!choice.topics.empty()) throw Error(choice.name + ": is no bag, so --topics means nothing");
  return open_folder(choice);
}

}  // namespace dkp_slam::apps
