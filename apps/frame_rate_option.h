#pragma once

#include <CLI/CLI.hpp>

namespace dkp_slam::apps {

/// Adds --frame-rate, Hz.
inline CLI::Option* add_frame_rate_option(CLI::App& command, double& frame_rate) {
  return command
      .add_option("--frame-rate", frame_rate,
                  "Images a second of a folder whose layout has no time stamps (ICL-NUIM, "
                  "7-Scenes, ScanNet)")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
}

}  // namespace dkp_slam::apps
