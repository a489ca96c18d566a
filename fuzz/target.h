#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "dkp_slam/error.h"

namespace dkp_slam::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// A parser of bytes from outside, and a few inputs that it takes, for a fuzzer to begin with.
struct Target {
  const char* name;
  /// Returns for every input, whatever it is; throws where something does not hold that must.
  void (*run)(Bytes);
  std::vector<std::string> (*seeds)();
};

/// Those of this program: one of libFuzzer's has one, the test all.
std::vector<Target>& targets();

struct Registration {
  explicit Registration(const Target& target) { targets().push_back(target); }
};

/// Throws unless it `holds`, which is a finding.
inline void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

/// True when `parse` took its input, false when it refused with an `Error`. Any other exception is
/// a finding.
template <class Parse>
bool takes(Parse parse) {
  try {
    parse();
  } catch (const Error& error) {
    require(*error.what() != '\0', "refused without a word");
    return false;
  }
  return true;
}

inline std::string text_of(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

inline Bytes bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Takes values off the front of the input; zeros where it has ended.
class Reader {
 public:
  explicit Reader(Bytes bytes) : bytes_(bytes) {}

  template <class Value>
  Value take() {
    Value value{};
    const std::size_t count = std::min(sizeof(value), bytes_.size());
    if (count > 0) std::memcpy(&value, bytes_.data(), count);
    bytes_ = bytes_.subspan(count);
    return value;
  }
  /// From 0 to `bound` - 1, of one byte.
  int below(int bound) { return take<std::uint8_t>() % bound; }
  bool empty() const { return bytes_.empty(); }
  Bytes rest() const { return bytes_; }

 private:
  Bytes bytes_;
};

/// A file that lies in memory and has a path, for what opens its file itself.
class InputFile {
 public:
  explicit InputFile(Bytes content);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return path_; }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
  std::string path_;
};

}  // namespace dkp_slam::fuzz
