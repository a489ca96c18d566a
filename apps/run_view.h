#pragma once

#include <memory>
#include <string>
#include <vector>

#include <spdlog/common.h>
#include <CLI/CLI.hpp>

#include "dkp_slam/sensor/rgbd_source.h"
#include "dkp_slam/system/slam.h"
#include "viewer/playback_gate.h"
#include "viewer/scene.h"
#include "viewer/server.h"

namespace dkp_slam::apps {

/// What the user asked of the live view.
struct ViewOptions {
  bool wanted = false;
  viewer::ServerOptions server;
  bool paused = false;  ///< from the beginning, until a page lets the playback go
  bool stay = false;    ///< open after the run, until Ctrl-C
};

/// Adds --port and --listen; returns them.
std::vector<CLI::Option*> add_server_options(CLI::App& command, ViewOptions& options);

/// The page of a run or a map, from when it is made until it goes. Says on stderr where it is:
/// "view: http://127.0.0.1:40123/".
class LiveView {
 public:
  /// `pausable`: whether pages may hold the playback up. Throws `Error` where the port cannot be
  /// had.
  LiveView(const ViewOptions& options, viewer::SceneInfo info, bool pausable);
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  /// Shows what happens there.
  void join(Slam& slam) const;
  /// The same frames, each when pages let it through.
  std::unique_ptr<RgbdSource> gated(std::unique_ptr<RgbdSource> source) const;
  viewer::Scene& scene() const { return *scene_; }
  /// Waits until the program is interrupted.
  void stay() const;

 private:
  const std::shared_ptr<viewer::Scene> scene_;
  const std::shared_ptr<viewer::PlaybackGate> gate_;  // null where nothing can be paused
  viewer::Server server_;
  spdlog::sink_ptr messages_;  // that takes what is logged to the page
};

}  // namespace dkp_slam::apps
