#pragma once

#include <string>

#include "apps/help/command_tree.h"

namespace dkp_slam::apps {

/// Script for bash that completes commands, options and the values of options that have few; what
/// is left are files. To be sourced, or put where bash-completion looks for it.
std::string bash_completion(const CommandEntry& program);
/// The same for zsh, which shows what each word means; a file `_dkp-slam` in a folder of `fpath`.
std::string zsh_completion(const CommandEntry& program);

}  // namespace dkp_slam::apps
