#include <memory>
#include <string>

#include <fmt/format.h>

#include "apps/commands.h"
#include "apps/help/command_tree.h"
#include "apps/help/completion.h"
#include "apps/help/man_page.h"
#include "apps/help/topics.h"
#include "apps/print_text.h"
#include "dkp_slam/version.h"

namespace dkp_slam::apps {
namespace {

std::string overview(const CLI::App& program) {
  std::string out = "Pages:\n";
  for (const HelpTopic& topic : help_topics()) {
    out += fmt::format("  dkp-slam help {:<14} {}\n", topic.name, topic.title());
  }
  out += "\nCommands, each with --help:\n";
  for (const CommandEntry& command : command_tree(program).commands) {
    out += fmt::format("  dkp-slam {:<14} {}\n", command.name, first_sentence(command.description));
  }
  return out;
}

void help(const CLI::App& program, const std::string& topic) {
  if (topic.empty()) {
    print_text(overview(program));
    return;
  }
  for (const HelpTopic& t : help_topics()) {
    if (t.name != topic) continue;
    print_text(t.text);
    return;
  }
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() != topic) continue;
    print_text(command->help());
    return;
  }
  std::string names;
  for (const HelpTopic& t : help_topics()) names += t.name + ", ";
  throw CLI::ValidationError(
      "help", fmt::format("no page '{}'; there are {}and each command", topic, names));
}

}  // namespace

void add_help_command(CLI::App& program) {
  const auto topic = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand(
      "help", "Prints a page for a kind of user, or the options of a command; alone, lists both.");
  command->add_option("TOPIC", *topic, "A page or a command");
  command->callback([&program, topic] { help(program, *topic); });
}

void add_completion_command(CLI::App& program) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand(
      "completion",
      "Prints the script that lets a shell complete commands, options and their values: source "
      "<(dkp-slam completion bash); for zsh a file _dkp-slam in a folder of fpath.");
  command->add_option("SHELL", *shell, "bash or zsh")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh"}));
  command->callback([&program, shell] {
    const CommandEntry tree = command_tree(program);
    print_text(*shell == "bash" ? bash_completion(tree) : zsh_completion(tree));
  });
}

void add_man_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("man", "Prints the manual page in roff: dkp-slam man | man -l -");
  command->callback([&program] { print_text(man_page(command_tree(program), DKP_SLAM_VERSION)); });
}

}  // namespace dkp_slam::apps
