#include "apps/help/command_tree.h"

#include <sstream>

namespace dkp_slam::apps {
namespace {

std::string without_full_stop(std::string text) {
  while (!text.empty() && (text.back() == '.' || text.back() == '\n')) text.pop_back();
  return text;
}

/// The names in "TEXT:{off,masks}".
std::vector<std::string> choices_of(const std::string& type) {
  const auto open = type.find('{'), close = type.find('}', open);
  if (open == std::string::npos || close == std::string::npos) return {};
  std::vector<std::string> names;
  std::istringstream list(type.substr(open + 1, close - open - 1));
  for (std::string name; std::getline(list, name, ',');) names.push_back(name);
  return names;
}

OptionEntry entry_of(const CLI::Option& option) {
  OptionEntry entry;
  for (const std::string& name : option.get_snames()) entry.names.push_back('-' + name);
  for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  if (entry.names.empty()) entry.positional = option.get_name();
  if (option.get_items_expected_max() != 0) {
    const std::string type = option.get_type_name();
    entry.choices = choices_of(type);
    entry.value = type.substr(0, type.find_first_of(":{ "));
    if (entry.value.empty()) entry.value = "VALUE";
  }
  entry.description = without_full_stop(option.get_description());
  entry.default_text = option.get_default_str();
  entry.required = option.get_required();
  return entry;
}

}  // namespace

CommandEntry command_tree(const CLI::App& app) {
  CommandEntry entry{app.get_name(), without_full_stop(app.get_description()), {}, {}};
  for (const CLI::Option* option : app.get_options()) entry.options.push_back(entry_of(*option));
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    entry.commands.push_back(command_tree(*command));
  }
  return entry;
}

std::string first_sentence(const std::string& text) {
  const auto end = text.find(". ");
  return without_full_stop(text.substr(0, end));
}

}  // namespace dkp_slam::apps
