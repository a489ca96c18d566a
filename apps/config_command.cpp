#include <cstdio>
#include <memory>

#include "apps/commands.h"
#include "apps/config_options.h"

namespace dkp_slam::apps {

void add_config_command(CLI::App& program) {
  const auto options = std::make_shared<ConfigOptions>();
  CLI::App* command = program.add_subcommand(
      "config", "Print the configuration with unit and meaning of each option, as YAML.");
  add_config_options(*command, *options);
  command->callback([options] {
    std::fputs(config_text(make_config(*options)).c_str(), stdout);
    std::fflush(stdout);
  });
}

}  // namespace dkp_slam::apps
