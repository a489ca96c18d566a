#pragma once

#include <string>

namespace dkp_slam::apps {

/// All of `text` to the standard output, at once. Throws `Error` where it cannot be written.
void print_text(const std::string& text);

}  // namespace dkp_slam::apps
