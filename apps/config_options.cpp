#include "apps/config_options.h"

#include "dkp_slam/config/yaml/option_file.h"
#include "dkp_slam/error.h"

namespace dkp_slam::apps {
namespace {

/// Sets what the user wrote on the command line.
void assign(const std::vector<std::string>& assignments, const char* option, SlamConfig& config) {
  OptionList list = OptionList::of(config);
  try {
    for (const std::string& assignment : assignments) list.assign(assignment);
    list.check();
  } catch (const Error& error) {
    throw CLI::ValidationError(option, error.what());
  }
}

/// As JSON has it: a number stays the number that its text is.
nlohmann::ordered_json value_of(const Option& option) {
  const bool text = std::holds_alternative<std::string*>(option.value) ||
                    std::holds_alternative<std::filesystem::path*>(option.value) ||
                    std::holds_alternative<Choice>(option.value);
  if (text) return option.text();
  return nlohmann::ordered_json::parse(option.text());
}

}  // namespace

void add_config_options(CLI::App& command, ConfigOptions& options) {
  command.add_option("--config", options.file,
                     "Configuration (YAML, see config/default.yaml); what it does not name stays "
                     "as built in");
  command
      .add_option("--set", options.assignments,
                  "One option of the configuration: part.field=value, for instance "
                  "tracking.local_keyframes=60; may be given again")
      ->allow_extra_args(false);
}

CLI::Option* add_shortcut(CLI::App& command, ConfigOptions& options, const std::string& name,
                          const std::string& field, const std::string& help) {
  return command.add_option_function<std::string>(
      name,
      [&options, field](const std::string& value) {
        options.shortcuts.push_back(field + "=" + value);
      },
      help);
}

CLI::Option* add_flag_shortcut(CLI::App& command, ConfigOptions& options, const std::string& name,
                               const std::string& field, const std::string& help) {
  return command.add_flag_callback(
      name, [&options, field] { options.shortcuts.push_back(field + "=true"); }, help);
}

SlamConfig make_config(const ConfigOptions& options) {
  SlamConfig config;
  if (!options.file.empty()) {
    OptionList list = OptionList::of(config);
    read_option_file(options.file, list);
    try {
      list.check();
    } catch (const Error& error) {
      throw Error(options.file.string() + ": " + error.what());
    }
  }
  assign(options.assignments, "--set", config);
  assign(options.shortcuts, "command line", config);
  return config;
}

std::string config_text(SlamConfig config) {
  return "# The configuration of dkp-slam, as `dkp-slam config` prints it. A file for --config "
         "names\n"
         "# what is to differ from it, and nothing else; docs/configuration.md.\n\n" +
         option_file_text(OptionList::of(config));
}

nlohmann::ordered_json config_json(SlamConfig config) {
  nlohmann::ordered_json json;
  const OptionList list = OptionList::of(config);
  for (const Option& option : list.options()) {
    nlohmann::ordered_json* at = &json;
    std::size_t begin = 0;
    for (std::size_t dot = option.name.find('.'); dot != std::string::npos;
         dot = option.name.find('.', begin)) {
      at = &(*at)[option.name.substr(begin, dot - begin)];
      begin = dot + 1;
    }
    (*at)[option.name.substr(begin)] = value_of(option);
  }
  return json;
}

}  // namespace dkp_slam::apps
