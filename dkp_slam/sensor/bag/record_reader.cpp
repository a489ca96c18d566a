#include "dkp_slam/sensor/bag/record_reader.h"

#include <algorithm>

#include <fmt/format.h>
#include <rosbag/exceptions.h>

namespace dkp_slam::ros1 {
namespace {

constexpr std::uint64_t length_bytes = 4;

/// Whether there are fields of <length>name=value from beginning to end, as rosbag takes for
/// granted.
bool is_fields(std::string_view text) {
  while (!text.empty()) {
    if (text.size() < length_bytes) return false;
    const std::uint64_t length = number_at<std::uint32_t>(text, 0);
    text.remove_prefix(length_bytes);
    if (length > text.size() || text.substr(0, length).find('=') == std::string_view::npos)
      return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace

void fail_record(std::uint64_t at) {
  throw rosbag::BagFormatException(fmt::format("the record at byte {} is not whole", at));
}

std::string_view Record::field(std::string_view name) const {
  std::string_view rest = header;
  while (rest.size() >= length_bytes) {
    const std::uint64_t length = number_at<std::uint32_t>(rest, 0);
    rest.remove_prefix(length_bytes);
    const std::string_view whole = rest.substr(0, length);
    rest.remove_prefix(std::min<std::uint64_t>(length, rest.size()));
    if (whole.size() > name.size() && whole.starts_with(name) && whole[name.size()] == '=') {
      return whole.substr(name.size() + 1);
    }
  }
  return {};
}

std::string RecordReader::bytes(std::uint64_t begin, std::uint64_t end) const {
  std::string text(end - begin, '\0');
  if (!fetch_(begin, text.data(), text.size())) fail_record(begin);
  return text;
}

Record RecordReader::read(std::uint64_t at, std::uint64_t end) const {
  constexpr std::uint32_t longest_header = 1'000'000;
  const std::uint32_t header = length_at(at, end);
  const std::uint64_t length_place = at + length_bytes + header;
  if (header > longest_header || length_place > end) fail_record(at);
  Record record;
  record.header = bytes(at + length_bytes, length_place);
  if (!is_fields(record.header)) fail_record(at);
  record.at = at;
  record.data = length_place + length_bytes;
  record.end = record.data + length_at(length_place, end);
  if (record.end > end) fail_record(at);
  if (record.op() == op_connection) check_connection(record);
  return record;
}

std::vector<std::uint32_t> RecordReader::message_places(std::uint64_t begin,
                                                        std::uint64_t end) const {
  std::vector<std::uint32_t> places;
  std::size_t sure = 0;
  for (std::uint64_t at = begin; at < end;) {
    const Record record = read(at, end);
    const auto op = record.op();
    if (op != op_message && op != op_connection) {
      places.resize(sure);
    } else {
      places.push_back(static_cast<std::uint32_t>(at - begin));
      if (op == op_message) sure = places.size();
    }
    at = record.end;
  }
  places.resize(sure);
  return places;
}

std::uint32_t RecordReader::length_at(std::uint64_t at, std::uint64_t end) const {
  if (at + length_bytes > end) fail_record(at);
  return number_at<std::uint32_t>(bytes(at, at + length_bytes), 0);
}

/// What a connection is called and holds is fields, too.
void RecordReader::check_connection(const Record& connection) const {
  constexpr std::uint64_t longest = 10'000'000;  // definitions of messages are a few thousand
  if (connection.end - connection.data > longest ||
      !is_fields(bytes(connection.data, connection.end))) {
    fail_record(connection.data);
  }
}

}  // namespace dkp_slam::ros1
