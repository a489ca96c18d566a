#include "bench/results/fingerprint.h"

#include <array>
#include <cstdint>
#include <fstream>

#include <fmt/format.h>

#include "dkp_slam/error.h"

namespace dkp_slam::bench {

std::string fingerprint(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(path.string() + ": cannot be read; build it, or name it with --program");
  // FNV-1a, 64 bits: guards against mix-ups, not against forgery.
  std::uint64_t hash = 14695981039346656037ULL;
  std::array<char, 1 << 16> buffer{};
  while (in.read(buffer.data(), buffer.size()) || in.gcount() > 0) {
    for (std::streamsize i = 0; i < in.gcount(); ++i) {
      hash = (hash ^ static_cast<unsigned char>(buffer[static_cast<std::size_t>(i)])) *
             1099511628211ULL;
    }
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace dkp_slam::bench
