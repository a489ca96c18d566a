#include "dkp_slam/evaluation/measure/machine.h"

#include <array>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "dkp_slam/version.h"

namespace dkp_slam {
namespace {

/// What follows `key` and the separator on the first line of a file that starts with it.
std::string field_of(const char* path, const std::string& key, char separator) {
  std::ifstream in(path);
  std::string line;
  while (std::getline(in, line)) {
    if (!line.starts_with(key)) continue;
    const std::size_t at = line.find(separator);
    if (at == std::string::npos) continue;
    const std::size_t first = line.find_first_not_of(" \t\"", at + 1);
    const std::size_t last = line.find_last_not_of(" \t\"");
    if (first != std::string::npos && last >= first) return line.substr(first, last - first + 1);
  }
  return "unknown";
}

std::string memory_size() {
  std::istringstream in(field_of("/proc/meminfo", "MemTotal", ':'));
  double kilobytes = 0.0;
  return in >> kilobytes ? fmt::format("{:.1f} GiB", kilobytes / (1024.0 * 1024.0)) : "unknown";
}

std::string commit() {
  const std::string command =
      fmt::format("git -C '{}' describe --always --dirty 2>/dev/null", DKP_SLAM_SOURCE_DIR);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::array<char, 128> buffer{};
  if (!pipe || !std::fgets(buffer.data(), buffer.size(), pipe.get())) return "";
  std::string text(buffer.data());
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string compiler_name() {
#ifdef __clang__
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

}  // namespace

Machine this_machine() {
  Machine machine;
  machine.processor = fmt::format("{}, {} cores", field_of("/proc/cpuinfo", "model name", ':'),
                                  std::thread::hardware_concurrency());
  machine.memory = memory_size();
  utsname kernel{};
  machine.system = field_of("/etc/os-release", "PRETTY_NAME", '=');
  if (uname(&kernel) == 0) machine.system += fmt::format(", {} {}", kernel.sysname, kernel.release);
  machine.compiler = fmt::format("{}, {} build", compiler_name(), DKP_SLAM_BUILD_TYPE);
  const std::string revision = commit();
  machine.version = DKP_SLAM_VERSION + (revision.empty() ? "" : ", commit " + revision);
  return machine;
}

std::string today() { return fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr))); }

std::optional<double> busy_seconds() {
  std::ifstream in("/proc/stat");
  std::string name;
  double user = 0.0, nice = 0.0, system = 0.0, idle = 0.0, wait = 0.0, irq = 0.0, soft_irq = 0.0,
         stolen = 0.0;
  if (!(in >> name >> user >> nice >> system >> idle >> wait >> irq >> soft_irq >> stolen)) {
    return std::nullopt;
  }
  return (user + nice + system + irq + soft_irq + stolen) /
         static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::string command_line(const std::vector<std::string>& arguments) {
  std::string out;
  for (std::string argument : arguments) {
    if (argument.starts_with("/")) {
      std::filesystem::path path(argument);
      if (!path.has_filename()) path = path.parent_path();
      argument = "DIR/" + path.filename().string();
    }
    const bool plain = !argument.empty() &&
                       argument.find_first_of(" \t\n'\"\\$`*?[]{}()<>|&;#~!") == std::string::npos;
    if (!out.empty()) out += ' ';
    if (plain) {
      out += argument;
      continue;
    }
    out += '\'';
    for (const char c : argument) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    out += '\'';
  }
  return out;
}

}  // namespace dkp_slam
