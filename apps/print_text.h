#pragma once

#include <string>

namespace dkp_slam::apps {

/// All of `text` to the standard output, at once. Throws `Error`, with what to do instead, where it
/// cannot be written.
void print_text(const std::string& text, const std::string& remedy = "send it elsewhere");

}  // namespace dkp_slam::apps
