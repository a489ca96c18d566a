#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "dkp_slam/sensor/bag/record_reader.h"

namespace dkp_slam {

/// Looks whether the records of a ROS 1 bag (format 2.0) and the fields of their headers lie where
/// their lengths and the index say: rosbag itself believes them, and reads past its memory, or asks
/// for gigabytes, where they are wrong. Bags of older formats and those without an index are left
/// to rosbag. What is wrong is thrown as rosbag throws it: `rosbag::BagException`.
class BagRecords {
 public:
  /// All but what compressed chunks hold; reads no message.
  explicit BagRecords(const std::string& file);
  BagRecords(const BagRecords&) = delete;
  BagRecords& operator=(const BagRecords&) = delete;

  /// Unpacks the compressed chunks that by the index hold messages of `nanoseconds` and before,
  /// each once: to be called before rosbag reads a message of that time.
  void check_until(std::uint64_t nanoseconds);

 private:
  struct Packed {
    std::uint64_t chunk = 0;                                          ///< its place in the file
    std::uint64_t first = std::numeric_limits<std::uint64_t>::max();  ///< of its messages, ns
  };

  void check_file();
  void walk_chunk(const ros1::Record& chunk);
  void check_index(const ros1::Record& index);
  void check_chunk_info(const ros1::Record& info) const;
  void check_packed(std::uint64_t chunk);
  std::vector<std::uint32_t> places_in(const ros1::Record& chunk) const;

  const std::uint64_t size_;
  std::ifstream stream_;
  const ros1::RecordReader reader_;
  std::vector<std::uint64_t> chunks_;  // rising
  std::vector<std::uint32_t> places_;  // of the last chunk's messages, rising
  bool knows_places_ = false;
  std::vector<Packed> packed_;  // by time
  std::size_t checked_ = 0;     // how many of them
};

}  // namespace dkp_slam
