#include "apps/source_choice.h"

#include <utility>

#include <spdlog/spdlog.h>

#include "apps/camera_choice.h"
#include "apps/progress.h"
#include "dkp_slam/error.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/stream/stream_source.h"
#include "dkp_slam/sensor/tum_source.h"

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

}  // namespace

bool is_stream(const std::string& name) { return StreamAddress::looks_like(name); }

bool is_socket(const std::string& name) { return is_stream(name) && name != "-"; }

OpenedSource open_source(const SourceChoice& choice) {
  if (is_stream(choice.name)) return open_driver(choice);
  OpenedSource opened;
  opened.camera_name = choose_camera(choice.name, choice.camera);
  if (choice.camera.empty()) spdlog::info("camera: {}", opened.camera_name);
  opened.camera = load_camera(opened.camera_name);
  TumOptions images;
  images.masks = choice.masks;
  images.depth = load_depth_correction(opened.camera_name);
  opened.source = open_tum_folder(choice.name, opened.camera, images);
  return opened;
}

}  // namespace dkp_slam::apps
