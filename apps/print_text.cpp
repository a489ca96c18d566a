#include "apps/print_text.h"

#include <cstdio>

#include "dkp_slam/error.h"

namespace dkp_slam::apps {

void print_text(const std::string& text, const std::string& remedy) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw Error("cannot write to the standard output; " + remedy);
  }
}

}  // namespace dkp_slam::apps
