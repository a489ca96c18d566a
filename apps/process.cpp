#include "apps/process.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <new>

#include <fcntl.h>
#include <unistd.h>
#include <opencv2/core.hpp>

namespace dkp_slam::apps {

void prepare_process() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    const bool closed = fcntl(descriptor, F_GETFD) == -1 && errno == EBADF;
    // open takes the lowest free number, which is this one: those below are open by now.
    if (closed && open("/dev/null", O_RDWR) != descriptor) return;
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

std::string message_of(const std::exception& error) {
  const auto* const opencv = dynamic_cast<const cv::Exception*>(&error);
  if (dynamic_cast<const std::bad_alloc*>(&error) ||
      (opencv && opencv->code == cv::Error::StsNoMem)) {
    return "out of memory; end other programs or raise the limit (ulimit -v)";
  }
  if (const auto* const files = dynamic_cast<const std::filesystem::filesystem_error*>(&error)) {
    return files->path1().string() + ": " + files->code().message() + "; check the path";
  }
  return opencv ? opencv->err : error.what();
}

std::string printable(std::string text) {
  const auto control = [](unsigned char c) { return (c < ' ' && c != '\n') || c == 0x7F; };
  std::replace_if(text.begin(), text.end(), control, '?');
  return text;
}

}  // namespace dkp_slam::apps
