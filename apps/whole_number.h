#pragma once

#include <charconv>
#include <cstdint>
#include <string>

namespace dkp_slam::apps {

/// A check for CLI11, which itself takes "-1" and numbers past the largest for some other number:
/// digits alone, at most 2^64 - 1. Empty when the text is such a number.
inline std::string check_whole_number(const std::string& text) {
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && rest == end ? "" : "not a whole number of 0 to 2^64 - 1: " + text;
}

}  // namespace dkp_slam::apps
