#include <memory>

#include "apps/commands.h"
#include "apps/config_options.h"
#include "apps/print_text.h"

namespace dkp_slam::apps {

void add_config_command(CLI::App& program) {
  const auto options = std::make_shared<ConfigOptions>();
  CLI::App* command = program.add_subcommand(
      "config", "Print the configuration with unit and meaning of each option, as YAML.");
  add_config_options(*command, *options);
  command->callback([options] {
    print_text(config_text(make_config(*options)), "send it to a file on a disk that has room");
  });
}

}  // namespace dkp_slam::apps
