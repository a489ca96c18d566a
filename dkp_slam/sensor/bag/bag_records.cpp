#include "dkp_slam/sensor/bag/bag_records.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

// http://wiki.ros.org/Bags/Format/2.0: records of <length><header><length><data>; a header is
// fields of <length>name=value. Numbers are little-endian.
constexpr std::string_view first_line = "#ROSBAG V2.0\n";
constexpr std::uint8_t op_index = 4, op_chunk = 5, op_connection = 7;
constexpr std::uint64_t length_bytes = 4;

template <class Number>
std::optional<Number> number_of(std::string_view value) {
  if (value.size() != sizeof(Number)) return std::nullopt;
  Number number;
  std::memcpy(&number, value.data(), sizeof(number));
  return number;
}

/// Whether there are fields of <length>name=value from beginning to end, as rosbag takes for
/// granted.
bool is_fields(std::string_view text) {
  while (!text.empty()) {
    if (text.size() < length_bytes) return false;
    const std::uint64_t length = *number_of<std::uint32_t>(text.substr(0, length_bytes));
    text.remove_prefix(length_bytes);
    if (length > text.size() || text.substr(0, length).find('=') == text.npos) return false;
    text.remove_prefix(length);
  }
  return true;
}

struct Record {
  std::string header;
  std::uint64_t data = 0, end = 0;  ///< places in the file, of the data and after them

  /// Empty where there is no such field.
  std::string_view field(std::string_view name) const {
    std::string_view rest = header;
    while (rest.size() >= length_bytes) {
      const std::uint64_t length = *number_of<std::uint32_t>(rest.substr(0, length_bytes));
      rest.remove_prefix(length_bytes);
      const std::string_view whole = rest.substr(0, length);
      rest.remove_prefix(std::min<std::uint64_t>(length, rest.size()));
      if (whole.size() > name.size() && whole.starts_with(name) && whole[name.size()] == '=') {
        return whole.substr(name.size() + 1);
      }
    }
    return {};
  }
};

class BagWalk {
 public:
  explicit BagWalk(const std::string& file) : size_(std::filesystem::file_size(file)) {
    // Small reads far apart: a buffer would be filled for each of them.
    stream_.rdbuf()->pubsetbuf(nullptr, 0);
    stream_.open(file, std::ios::binary);
  }

  void check() {
    std::string line(first_line.size(), '\0');
    if (!stream_.read(line.data(), static_cast<std::streamsize>(line.size())) || line != first_line)
      return;
    Record record = read(first_line.size(), size_);
    if (number_of<std::uint64_t>(record.field("index_pos")).value_or(0) == 0) return;
    while (record.end < size_) {
      record = read(record.end, size_);
      const auto op = number_of<std::uint8_t>(record.field("op"));
      if (op == op_chunk) walk_chunk(record);
      if (op == op_index) check_index(record);
    }
  }

 private:
  [[noreturn]] static void fail(std::uint64_t at) {
    throw Error(fmt::format("the record at byte {} is not whole", at));
  }

  std::uint32_t length_at(std::uint64_t at, std::uint64_t end) {
    std::string bytes(length_bytes, '\0');
    stream_.seekg(static_cast<std::streamoff>(at));
    if (at + length_bytes > end || !stream_.read(bytes.data(), length_bytes)) fail(at);
    return *number_of<std::uint32_t>(bytes);
  }

  /// The record that begins at `at` and ends at `end` at the latest.
  Record read(std::uint64_t at, std::uint64_t end) {
    constexpr std::uint32_t longest_header = 1'000'000;
    const std::uint32_t header = length_at(at, end);
    if (header > longest_header || at + length_bytes + header > end) fail(at);
    Record record;
    record.header.resize(header);
    if (!stream_.read(record.header.data(), header) || !is_fields(record.header)) fail(at);
    const std::uint64_t length_place = at + length_bytes + header;
    const std::uint32_t data = length_at(length_place, end);
    record.data = length_place + length_bytes;
    record.end = record.data + data;
    if (record.end > end) fail(at);
    if (number_of<std::uint8_t>(record.field("op")) == op_connection) check_connection(record);
    return record;
  }

  /// What a connection is called and holds is fields, too.
  void check_connection(const Record& connection) {
    constexpr std::uint64_t longest = 10'000'000;  // definitions of messages are a few thousand
    const std::uint64_t size = connection.end - connection.data;
    if (size > longest) fail(connection.data);
    std::string fields(size, '\0');
    stream_.seekg(static_cast<std::streamoff>(connection.data));
    if (!stream_.read(fields.data(), static_cast<std::streamsize>(size)) || !is_fields(fields)) {
      fail(connection.data);
    }
  }

  /// Notes where the chunk's messages begin, by which the index names them.
  void walk_chunk(const Record& chunk) {
    constexpr std::uint32_t largest = 1'000'000'000;
    const auto size = number_of<std::uint32_t>(chunk.field("size"));
    if (!size || *size > largest) fail(chunk.data);
    places_.clear();
    chunk_size_ = *size;
    plain_ = chunk.field("compression") == "none";
    if (!plain_) return;  // rosbag unpacks it into as many bytes
    if (*size != chunk.end - chunk.data) fail(chunk.data);
    for (std::uint64_t at = chunk.data; at < chunk.end;) {
      places_.push_back(static_cast<std::uint32_t>(at - chunk.data));
      at = read(at, chunk.end).end;
    }
  }

  void check_index(const Record& index) {
    constexpr std::uint64_t entry = 12;  // a time and a place in the chunk
    const auto count = number_of<std::uint32_t>(index.field("count"));
    if (!count || index.end - index.data != entry * *count) fail(index.data);
    std::string entries(entry * *count, '\0');
    stream_.seekg(static_cast<std::streamoff>(index.data));
    if (!stream_.read(entries.data(), static_cast<std::streamsize>(entries.size()))) {
      fail(index.data);
    }
    for (std::uint64_t at = 0; at < entries.size(); at += entry) {
      std::uint32_t place = 0;
      std::memcpy(&place, &entries[at + entry - sizeof(place)], sizeof(place));
      const bool there =
          plain_ ? std::binary_search(places_.begin(), places_.end(), place) : place < chunk_size_;
      if (!there) fail(index.data);
    }
  }

  std::ifstream stream_;
  const std::uint64_t size_;
  std::vector<std::uint32_t> places_;  // of the last chunk's records, rising
  std::uint32_t chunk_size_ = 0;
  bool plain_ = false;
};

}  // namespace

void check_bag_records(const std::string& file) { BagWalk(file).check(); }

}  // namespace dkp_slam
