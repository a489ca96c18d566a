#include "dkp_slam/evaluation/measure/fingerprint.h"

#include <array>
#include <cstdint>
#include <fstream>

#include <fmt/format.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

// FNV-1a, 64 bits: guards against mix-ups, not against forgery.
constexpr std::uint64_t start_hash = 14695981039346656037ULL;

std::uint64_t hashed(std::uint64_t hash, std::string_view bytes) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

}  // namespace

std::string fingerprint(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(path.string() + ": cannot be read; is it there and are you allowed to?");
  std::uint64_t hash = start_hash;
  std::array<char, 1 << 16> buffer{};
  while (in.read(buffer.data(), buffer.size()) || in.gcount() > 0) {
    hash = hashed(hash, {buffer.data(), static_cast<std::size_t>(in.gcount())});
  }
  return fmt::format("{:016x}", hash);
}

std::string text_fingerprint(std::string_view text) {
  return fmt::format("{:016x}", hashed(start_hash, text));
}

}  // namespace dkp_slam
