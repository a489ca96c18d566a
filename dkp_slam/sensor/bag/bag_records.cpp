#include "dkp_slam/sensor/bag/bag_records.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include <bzlib.h>
#include <fmt/format.h>
#include <rosbag/chunked_file.h>
#include <rosbag/exceptions.h>

namespace dkp_slam {
namespace {

using ros1::fail_record;
using ros1::number_at;
using ros1::number_of;
using ros1::Record;

constexpr std::string_view first_line = "#ROSBAG V2.0\n";

/// A chunk's bytes, `size` at most. rosbag itself does not notice when bzip2 gives fewer.
std::string unpacked(std::string packed, std::string_view compression, unsigned size) {
  std::string bytes(size, '\0');
  if (compression == "lz4") {
    rosbag::ChunkedFile().decompress(
        rosbag::compression::LZ4, reinterpret_cast<std::uint8_t*>(bytes.data()), size,
        reinterpret_cast<std::uint8_t*>(packed.data()), static_cast<unsigned>(packed.size()));
    return bytes;
  }
  if (compression != "bz2")
    throw rosbag::BagFormatException(fmt::format("compression '{}' is not known", compression));
  if (BZ2_bzBuffToBuffDecompress(bytes.data(), &size, packed.data(),
                                 static_cast<unsigned>(packed.size()), 0, 0) != BZ_OK) {
    throw rosbag::BagFormatException("a chunk cannot be unpacked");
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

BagRecords::BagRecords(const std::string& file)
    : size_(std::filesystem::file_size(file)),
      reader_([this](std::uint64_t place, char* bytes, std::uint64_t size) {
        stream_.clear();
        stream_.seekg(static_cast<std::streamoff>(place));
        return static_cast<bool>(stream_.read(bytes, static_cast<std::streamsize>(size)));
      }) {
  // Small reads far apart: a buffer would be filled for each of them.
  stream_.rdbuf()->pubsetbuf(nullptr, 0);
  stream_.open(file, std::ios::binary);
  check_file();
}

void BagRecords::check_until(std::uint64_t nanoseconds) {
  for (; checked_ < packed_.size() && packed_[checked_].first <= nanoseconds; ++checked_) {
    check_packed(packed_[checked_].chunk);
  }
}

void BagRecords::check_file() {
  if (size_ < first_line.size() || reader_.bytes(0, first_line.size()) != first_line) return;
  Record record = reader_.read(first_line.size(), size_);
  const auto index = number_of<std::uint64_t>(record.field("index_pos")).value_or(0);
  if (index == 0) return;
  bool has_index = index == size_;
  while (record.end < size_) {
    record = reader_.read(record.end, size_);
    has_index |= record.at == index;
    const auto op = record.op();
    if (op == ros1::op_chunk) walk_chunk(record);
    if (op == ros1::op_index) check_index(record);
    if (op == ros1::op_chunk_info) check_chunk_info(record);
  }
  if (!has_index) fail_record(index);
  std::stable_sort(packed_.begin(), packed_.end(),
                   [](const Packed& a, const Packed& b) { return a.first < b.first; });
}

/// Notes where the chunk's messages begin, by which the index names them.
void BagRecords::walk_chunk(const Record& chunk) {
  constexpr std::uint32_t largest = 1'000'000'000;
  const auto size = number_of<std::uint32_t>(chunk.field("size"));
  if (!size || *size > largest) fail_record(chunk.data);
  chunks_.push_back(chunk.at);
  places_.clear();
  knows_places_ = chunk.field("compression") == "none";
  if (!knows_places_) {
    packed_.push_back({.chunk = chunk.at});
    return;
  }
  if (*size != chunk.end - chunk.data) fail_record(chunk.data);
  places_ = reader_.message_places(chunk.data, chunk.end);
}

/// Of the last chunk: its places, or of a compressed one that is not unpacked yet its first time.
void BagRecords::check_index(const Record& index) {
  constexpr std::uint64_t entry = 12;  // seconds, nanoseconds, place in the chunk
  const auto count = number_of<std::uint32_t>(index.field("count"));
  if (!count || index.end - index.data != entry * *count) fail_record(index.data);
  const std::string entries = reader_.bytes(index.data, index.end);
  for (std::uint64_t at = 0; at < entries.size(); at += entry) {
    if (knows_places_) {
      const auto place = number_at<std::uint32_t>(entries, at + 8);
      if (!std::binary_search(places_.begin(), places_.end(), place)) fail_record(index.data);
    } else if (!packed_.empty()) {
      const std::uint64_t time = number_at<std::uint32_t>(entries, at) * 1'000'000'000ULL +
                                 number_at<std::uint32_t>(entries, at + 4);
      packed_.back().first = std::min(packed_.back().first, time);
    }
  }
}

void BagRecords::check_chunk_info(const Record& info) const {
  const auto chunk = number_of<std::uint64_t>(info.field("chunk_pos"));
  if (!chunk || !std::binary_search(chunks_.begin(), chunks_.end(), *chunk)) fail_record(info.at);
}

void BagRecords::check_packed(std::uint64_t chunk) {
  Record record = reader_.read(chunk, size_);
  places_ = places_in(record);
  knows_places_ = true;
  while (record.end < size_) {
    record = reader_.read(record.end, size_);
    if (record.op() != ros1::op_index) break;
    check_index(record);
  }
}

std::vector<std::uint32_t> BagRecords::places_in(const Record& chunk) const {
  // What closes a chunk is its size, after a message: far less than what may be said.
  constexpr std::uint32_t largest = 300'000'000;
  const auto size = number_of<std::uint32_t>(chunk.field("size")).value_or(0);
  if (size > largest) fail_record(chunk.data);
  const std::string bytes =
      unpacked(reader_.bytes(chunk.data, chunk.end), chunk.field("compression"), size);
  if (bytes.size() != size) fail_record(chunk.data);
  const ros1::RecordReader reader([&](std::uint64_t place, char* to, std::uint64_t count) {
    return bytes.copy(to, count, place) == count;
  });
  return reader.message_places(0, size);
}

}  // namespace dkp_slam
