#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "dkp_slam/system/config.h"

namespace dkp_slam::apps {

/// Where the user wants the configuration to differ from what is built in.
struct ConfigOptions {
  std::filesystem::path file;            ///< --config; empty for none
  std::vector<std::string> assignments;  ///< --set part.field=value, after the file
  std::vector<std::string> shortcuts;    ///< of options that are short for a --set, after those
};

/// Adds --config and --set.
void add_config_options(CLI::App& command, ConfigOptions& options);

/// Adds an option that is short for `--set field=VALUE`.
CLI::Option* add_shortcut(CLI::App& command, ConfigOptions& options, const std::string& name,
                          const std::string& field, const std::string& help);
/// Adds a flag that is short for `--set field=true`.
CLI::Option* add_flag_shortcut(CLI::App& command, ConfigOptions& options, const std::string& name,
                               const std::string& field, const std::string& help);

/// The whole configuration, checked, but for the camera. Throws `Error` for what is wrong in the
/// file, and CLI::ValidationError for what is wrong on the command line.
SlamConfig make_config(const ConfigOptions& options);

/// All options of a configuration as a file for --config.
std::string config_text(SlamConfig config);
/// The same as JSON, a part in a part.
nlohmann::ordered_json config_json(SlamConfig config);

}  // namespace dkp_slam::apps
