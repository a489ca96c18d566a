#pragma once

#include <optional>
#include <string>
#include <vector>

namespace dkp_slam {

/// Where and with what figures were taken, in words.
struct Machine {
  std::string processor;  ///< model and number of cores
  std::string memory;
  std::string system;    ///< distribution and kernel
  std::string compiler;  ///< that built this program
  std::string version;   ///< of the project, with the commit of the source tree where there is git
};

Machine this_machine();

/// Today, YYYY-MM-DD, UTC.
std::string today();

/// Seconds that all cores together have spent on anything but idling since the machine started;
/// nothing where the kernel does not tell.
std::optional<double> busy_seconds();

/// A command line as one could type it. An absolute path is cut to its last component ("DIR/name"):
/// a report is no place for the folders of the machine it was made on.
std::string command_line(const std::vector<std::string>& arguments);

}  // namespace dkp_slam
