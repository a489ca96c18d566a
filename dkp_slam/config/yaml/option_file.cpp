#include "dkp_slam/config/yaml/option_file.h"

#include <algorithm>
#include <fstream>
#include <ios>
#include <set>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t comment_column = 36;

class Reader {
 public:
  Reader(const fs::path& file, OptionList& options) : file_(file), options_(options) {}

  void read_part(const YAML::Node& map, const std::string& path) {
    std::set<std::string> seen;
    for (const auto& entry : map) {
      if (!entry.first.IsScalar()) fail(entry.first, "a name must stand here");
      const std::string name = path + entry.first.Scalar();
      if (!seen.insert(name).second) fail(entry.first, name + " is given twice");
      read_entry(entry.first, name, entry.second);
    }
  }

  [[noreturn]] void fail(const YAML::Node& at, const std::string& problem) const {
    fail_at(at.Mark(), problem);
  }
  [[noreturn]] void fail_at(const YAML::Mark& mark, const std::string& problem) const {
    throw Error(fmt::format("{}:{}: {}", file_.string(), mark.line + 1, problem));
  }

 private:
  void read_entry(const YAML::Node& key, const std::string& name, const YAML::Node& value) {
    if (Option* option = options_.find(name)) {
      if (!value.IsScalar()) {
        fail(key, fmt::format("{} has no single value; it must be {}", name, option->wanted()));
      }
      try {
        option->assign(value.Scalar());
      } catch (const Error& error) {
        fail(key, error.what());
      }
      return;
    }
    const auto& parts = options_.parts();
    if (std::none_of(parts.begin(), parts.end(), [&](const auto& p) { return p.name == name; })) {
      fail(key,
           fmt::format("there is no option {}; did you mean {}?", name, options_.nearest(name)));
    }
    if (!value.IsMap()) fail(key, name + " is a part; its options belong below it, indented");
    read_part(value, name + ".");
  }

  const fs::path& file_;
  OptionList& options_;
};

std::string read_text(const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error)) {
    throw Error(file.string() + ": a folder, not a configuration file");
  }
  // A pipe will do, and where it never ends it is left.
  constexpr std::streamsize most_bytes = 1'000'000;
  std::ifstream in(file);
  std::string text(most_bytes + 1, '\0');
  if (in) in.read(text.data(), most_bytes + 1);
  if (!in.is_open() || in.bad()) {
    throw Error(file.string() + ": cannot be read; is there such a configuration file?");
  }
  if (in.gcount() > most_bytes) {
    throw Error(file.string() + ": over a megabyte, no configuration file; check the path");
  }
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

/// In quotes, for a text may look like anything; in double ones where only escapes hold it.
std::string quoted(const std::string& text) {
  if (std::any_of(text.begin(), text.end(), is_control)) {
    std::string result = "\"";
    for (const char c : text) {
      if (is_control(c)) {
        result += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
      } else {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
      }
    }
    return result + '"';
  }
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

/// The value as YAML reads it back.
std::string scalar(const Option& option) {
  const bool is_text = std::holds_alternative<std::string*>(option.value) ||
                       std::holds_alternative<fs::path*>(option.value);
  return is_text ? quoted(option.text()) : option.text();
}

std::string comment(const Option& option) {
  std::string text = option.unit.empty() ? "" : "[" + option.unit + "] ";
  text += option.meaning;
  if (const auto* choice = std::get_if<Choice>(&option.value)) {
    text += fmt::format("; one of {}", fmt::join(choice->names, ", "));
  } else if (const std::string bounds = option.bounds.text(); !bounds.empty()) {
    text += "; " + bounds;
  }
  return text;
}

std::size_t depth_of(const std::string& name) {
  return static_cast<std::size_t>(std::count(name.begin(), name.end(), '.'));
}

std::string line_of(const std::string& name, const std::string& value, const std::string& remark) {
  std::string line = std::string(2 * depth_of(name), ' ') + name.substr(name.rfind('.') + 1) + ":";
  if (!value.empty()) line += " " + value;
  return fmt::format("{:<{}}  # {}\n", line, comment_column, remark);
}

}  // namespace

void read_option_file(const fs::path& file, OptionList& options) {
  const std::string text = read_text(file);
  Reader reader(file, options);
  try {
    const YAML::Node root = YAML::Load(text);
    if (root.IsNull()) throw Error(file.string() + ":1: empty; give at least one option");
    if (!root.IsMap()) reader.fail(root, "no map of options, such as 'tracking: {...}'");
    reader.read_part(root, "");
  } catch (const YAML::Exception& error) {
    reader.fail_at(error.mark, "no YAML: " + error.msg);
  }
}

std::string option_file_text(const OptionList& options) {
  std::string text;
  auto part = options.parts().begin();
  for (const Option& option : options.options()) {
    for (; part != options.parts().end() && option.name.starts_with(part->name + "."); ++part) {
      if (depth_of(part->name) == 0) text += '\n';
      text += line_of(part->name, "", part->meaning);
    }
    text += line_of(option.name, scalar(option), comment(option));
  }
  return text;
}

}  // namespace dkp_slam
