#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace dkp_slam::apps {

/// An option or a positional argument, as its command declares it.
struct OptionEntry {
  std::vector<std::string> names;    ///< "--out", "-h"; empty for a positional
  std::string positional;            ///< its name; empty for an option
  std::string value;                 ///< what it takes ("TEXT", "INT"); empty for a flag
  std::vector<std::string> choices;  ///< the values it takes, where they are few
  std::string description;           ///< ends without a full stop
  std::string default_text;          ///< empty where there is none
  bool required = false;
};

/// A command with all that can be said about it: what help pages and completion are made of.
struct CommandEntry {
  std::string name;
  std::string description;
  std::vector<OptionEntry> options;
  std::vector<CommandEntry> commands;
};

/// Reads the very tables that the command line is parsed by.
CommandEntry command_tree(const CLI::App& app);

/// Text up to its first full stop, without it.
std::string first_sentence(const std::string& text);

}  // namespace dkp_slam::apps
