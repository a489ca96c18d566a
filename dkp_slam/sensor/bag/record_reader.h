#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dkp_slam::ros1 {

// http://wiki.ros.org/Bags/Format/2.0: records of <length><header><length><data>; a header is
// fields of <length>name=value. Numbers are little-endian.

constexpr std::uint8_t op_message = 2, op_index = 4, op_chunk = 5, op_chunk_info = 6,
                       op_connection = 7;

/// Throws the `rosbag::BagFormatException` of a record that begins at this byte.
[[noreturn]] void fail_record(std::uint64_t at);

/// The number at a place of a text that holds it.
template <class Number>
Number number_at(std::string_view text, std::size_t at) {
  Number number;
  std::memcpy(&number, text.substr(at, sizeof(number)).data(), sizeof(number));
  return number;
}

/// A field's value as a number; null where it is of another size.
template <class Number>
std::optional<Number> number_of(std::string_view value) {
  if (value.size() != sizeof(Number)) return std::nullopt;
  return number_at<Number>(value, 0);
}

struct Record {
  std::string header;
  std::uint64_t at = 0, data = 0, end = 0;  ///< places: of the record, its data and after them

  /// Empty where there is no such field.
  std::string_view field(std::string_view name) const;
  std::optional<std::uint8_t> op() const { return number_of<std::uint8_t>(field("op")); }
};

/// Records that follow one another, in a file or in memory. What is called throws
/// `rosbag::BagFormatException` where they do not lie where their lengths say.
class RecordReader {
 public:
  /// Copies `size` bytes from a place; false where they are not.
  using Fetch = std::function<bool(std::uint64_t place, char* bytes, std::uint64_t size)>;
  explicit RecordReader(Fetch fetch) : fetch_(std::move(fetch)) {}

  std::string bytes(std::uint64_t begin, std::uint64_t end) const;
  /// The record that begins at `at` and ends at `end` at the latest.
  Record read(std::uint64_t at, std::uint64_t end) const;
  /// Where an index may send rosbag to, from `begin` on, rising: to a message, or to the
  /// connections right before one, which it leaps over.
  std::vector<std::uint32_t> message_places(std::uint64_t begin, std::uint64_t end) const;

 private:
  std::uint32_t length_at(std::uint64_t at, std::uint64_t end) const;
  void check_connection(const Record& connection) const;

  Fetch fetch_;
};

}  // namespace dkp_slam::ros1
