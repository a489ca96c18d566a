#pragma once

#include <string>

#include "apps/help/command_tree.h"

namespace dkp_slam::apps {

/// The manual page of the whole program with all its commands, in roff, section 1.
std::string man_page(const CommandEntry& program, const std::string& version);

}  // namespace dkp_slam::apps
