#include "apps/help/man_page.h"

#include <fmt/format.h>

namespace dkp_slam::apps {
namespace {

/// For roff: a backslash is a command, '-' a hyphen where a user would copy a minus, and a line
/// that begins with a dot or an apostrophe a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\n')
      out += ' ';
    else if (c == '\'')
      out += "\\(aq";
    else
      out += c;
  }
  return out.empty() || out.front() != '.' ? out : "\\&" + out;
}

std::string option_text(const OptionEntry& option) {
  std::string head;
  for (const std::string& name : option.names) {
    if (!head.empty()) head += ", ";
    head += "\\fB" + roff(name) + "\\fR";
  }
  if (option.names.empty()) head = "\\fI" + roff(option.positional) + "\\fR";
  if (!option.choices.empty()) {
    head += ' ' + roff(fmt::format("{}", fmt::join(option.choices, "|")));
  } else if (!option.names.empty() && !option.value.empty()) {
    head += " \\fI" + roff(option.value) + "\\fR";
  }
  std::string text = option.description;
  if (option.required) text += " (required)";
  if (!option.default_text.empty()) text += fmt::format(" (default: {})", option.default_text);
  return fmt::format(".TP\n{}\n{}.\n", head, roff(text));
}

void add_command(const CommandEntry& command, const std::string& before, std::string& out) {
  const std::string path = before.empty() ? command.name : before + ' ' + command.name;
  if (!before.empty()) {
    out += fmt::format(".SS {}\n{}.\n", roff(path), roff(command.description));
  }
  for (const OptionEntry& option : command.options) out += option_text(option);
  for (const CommandEntry& c : command.commands) add_command(c, path, out);
}

}  // namespace

std::string man_page(const CommandEntry& program, const std::string& version) {
  std::string out = fmt::format(
      ".TH DKP\\-SLAM 1 \"\" \"dkp-slam {0}\" \"User commands\"\n"
      ".SH NAME\ndkp\\-slam \\- visual SLAM for rooms with people in them\n"
      ".SH SYNOPSIS\n.B dkp\\-slam\n.I COMMAND\n[\\fIOPTION\\fR]...\n"
      ".SH DESCRIPTION\n{1}.\n.PP\n\\fBdkp\\-slam help\\fR lists pages for users.\n"
      ".SH COMMANDS AND OPTIONS\n",
      version, roff(program.description));
  add_command(program, "", out);
  out +=
      ".SH EXIT STATUS\n0: done. 1: it failed, one line says why. 2: wrong use. 130: stopped by "
      "Ctrl\\-C; what there was is saved.\n";
  return out;
}

}  // namespace dkp_slam::apps
