#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "apps/config_options.h"
#include "apps/dense_files.h"
#include "apps/run_view.h"
#include "dkp_slam/sensor/layout/image_folder.h"
#include "dkp_slam/system/config.h"

namespace dkp_slam::apps {

/// What the user asked of `dkp-slam run`.
struct RunOptions {
  std::string sequence;  ///< a folder, a bag, or the address of a stream
  std::string topics;    ///< of a bag; empty: found
  std::string camera;
  double frame_rate = usual_frame_rate;  ///< Hz, of a folder without time stamps
  std::filesystem::path out, classes;
  std::filesystem::path map;         ///< file to go on from and to keep up to date; empty for none
  std::filesystem::path localize;    ///< map file to find the camera in; empty for none
  std::filesystem::path detections;  ///< recorded ones instead of a detector's; empty for none
  std::filesystem::path masks;       ///< folder of masks instead of a detector; empty for none
  ConfigOptions config;
  std::optional<double> rate;  ///< in real time: so many times as fast as it was recorded
  bool offline = false;        ///< drop no frame of a socket
  double reconnect = 30.0;     ///< seconds that a socket waits for a driver to come back
  bool one_at_a_time = false;
  bool preload = false;  ///< read all images before the first frame
  bool overlay = false;
  bool save_masks = false;
  int overlay_every = 30;         ///< frames; one picture a second
  std::filesystem::path profile;  ///< trace of all stages and threads; empty for none
  ViewOptions view;
  DenseFiles dense;
};

/// Adds what names the source: SEQUENCE, --source and how a socket is treated.
void add_source_options(CLI::App& command, RunOptions& options);

/// Adds every other option of `dkp-slam run` but for --out and those of the view.
void add_run_options(CLI::App& command, RunOptions& options);

/// The configuration of the run that is asked for, all but its camera. Throws CLI::ValidationError
/// for options that do not go together or with the source, `Error` for a configuration's mistakes.
SlamConfig config_of(const RunOptions& options);

}  // namespace dkp_slam::apps
