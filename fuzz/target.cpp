#include "fuzz/target.h"

#include <sys/mman.h>
#include <unistd.h>

namespace dkp_slam::fuzz {

std::vector<Target>& targets() {
  static std::vector<Target> all;
  return all;
}

InputFile::InputFile(Bytes content)
    : descriptor_(memfd_create("input", 0)), path_("/proc/self/fd/" + std::to_string(descriptor_)) {
  for (std::size_t done = 0; done < content.size();) {
    const ssize_t written = ::write(descriptor_, content.data() + done, content.size() - done);
    if (written <= 0) throw std::runtime_error("no memory for an input");
    done += static_cast<std::size_t>(written);
  }
  lseek(descriptor_, 0, SEEK_SET);
}

InputFile::~InputFile() { close(descriptor_); }

}  // namespace dkp_slam::fuzz
