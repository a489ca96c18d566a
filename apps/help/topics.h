#pragma once

#include <string>
#include <vector>

namespace dkp_slam::apps {

/// A page for a kind of user: a file of docs/help, built into the program.
struct HelpTopic {
  std::string name;  ///< "first-run"
  std::string text;  ///< Markdown; its first line is "# Title"

  std::string title() const { return text.substr(2, text.find('\n') - 2); }
};

/// In the order in which somebody new would read them.
const std::vector<HelpTopic>& help_topics();

}  // namespace dkp_slam::apps
