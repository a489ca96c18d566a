#include "apps/help/completion.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace dkp_slam::apps {
namespace {

/// A command with the words that lead to it: "dkp-slam map merge".
struct Place {
  std::string path;
  const CommandEntry* command = nullptr;
};

void collect(const CommandEntry& command, const std::string& before, std::vector<Place>& places) {
  const std::string path = before.empty() ? command.name : before + ' ' + command.name;
  places.push_back({path, &command});
  for (const CommandEntry& c : command.commands) collect(c, path, places);
}

std::vector<Place> places_of(const CommandEntry& program) {
  std::vector<Place> places;
  collect(program, "", places);
  return places;
}

std::string joined(const std::vector<std::string>& words, const char* between) {
  return fmt::format("{}", fmt::join(words, between));
}

/// For inside single quotes of a shell.
std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return '\'' + out + '\'';
}

/// The same for zsh's _describe, where a colon ends the word.
std::string described(const std::string& word, const std::string& meaning) {
  return quoted(word + ':' + first_sentence(meaning));
}

/// Branches `path:option) ...` that offer the values of an option.
template <typename Body>
std::string value_branches(const std::vector<Place>& places, Body body) {
  std::string out;
  for (const Place& place : places) {
    for (const OptionEntry& option : place.command->options) {
      if (option.names.empty() || option.value.empty()) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : option.names) {
        patterns.push_back(quoted(place.path + ':' + name));
      }
      out += fmt::format("    {}) {} ;;\n", joined(patterns, "|"), body(option));
    }
  }
  return out;
}

/// The word list of the commands that lead on from each place, to walk down the command line by.
std::string path_branches(const std::vector<Place>& places) {
  std::string out;
  for (const Place& place : places) {
    for (const CommandEntry& c : place.command->commands) {
      out += fmt::format("      {}) place={} ;;\n", quoted(place.path + ':' + c.name),
                         quoted(place.path + ' ' + c.name));
    }
  }
  return out;
}

}  // namespace

std::string bash_completion(const CommandEntry& program) {
  const std::vector<Place> places = places_of(program);
  std::string words;
  for (const Place& place : places) {
    std::vector<std::string> commands, options;
    for (const CommandEntry& c : place.command->commands) commands.push_back(c.name);
    for (const OptionEntry& o : place.command->options) {
      options.insert(options.end(), o.names.begin(), o.names.end());
    }
    words += fmt::format("    {}) commands={} options={} ;;\n", quoted(place.path),
                         quoted(joined(commands, " ")), quoted(joined(options, " ")));
  }
  const std::string values = value_branches(places, [](const OptionEntry& option) {
    return option.choices.empty() ? std::string("COMPREPLY=($(compgen -f -- \"$word\")); return")
                                  : fmt::format("COMPREPLY=($(compgen -W {} -- \"$word\")); return",
                                                quoted(joined(option.choices, " ")));
  });
  return fmt::format(R"(# Completion of dkp-slam for bash, made by 'dkp-slam completion bash'.
_dkp_slam() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
  local place='{0}' commands='' options='' i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$place:${{COMP_WORDS[i]}}" in
{1}    esac
  done
  case "$place:$before" in
{2}  esac
  case "$place" in
{3}  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$word"))
  else
    COMPREPLY=($(compgen -W "$commands" -- "$word"))
    [[ -n $commands ]] || COMPREPLY=($(compgen -f -- "$word"))
  fi
}}
complete -o filenames -F _dkp_slam {0}
)",
                     program.name, path_branches(places), values, words);
}

std::string zsh_completion(const CommandEntry& program) {
  const std::vector<Place> places = places_of(program);
  std::string words;
  for (const Place& place : places) {
    std::vector<std::string> commands, options;
    for (const CommandEntry& c : place.command->commands) {
      commands.push_back(described(c.name, c.description));
    }
    for (const OptionEntry& o : place.command->options) {
      for (const std::string& name : o.names) options.push_back(described(name, o.description));
    }
    words += fmt::format("    {}) commands=({}) options=({}) ;;\n", quoted(place.path),
                         joined(commands, " "), joined(options, " "));
  }
  const std::string values = value_branches(places, [](const OptionEntry& option) {
    if (option.choices.empty()) return std::string("_files; return");
    std::vector<std::string> choices;
    for (const std::string& choice : option.choices) choices.push_back(quoted(choice));
    return fmt::format("compadd -- {}; return", joined(choices, " "));
  });
  return fmt::format(R"(#compdef {0}
# Completion of dkp-slam for zsh, made by 'dkp-slam completion zsh'.
_dkp_slam() {{
  local place='{0}' i
  local -a commands options
  for ((i = 2; i < CURRENT; ++i)); do
    case "$place:${{words[i]}}" in
{1}    esac
  done
  case "$place:${{words[CURRENT-1]}}" in
{2}  esac
  case "$place" in
{3}  esac
  if [[ $PREFIX == -* ]]; then
    _describe option options
  elif (( $#commands )); then
    _describe command commands
  else
    _files
  fi
}}
_dkp_slam "$@"
)",
                     program.name, path_branches(places), values, words);
}

}  // namespace dkp_slam::apps
