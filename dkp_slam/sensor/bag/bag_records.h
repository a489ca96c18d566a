#pragma once

#include <string>

namespace dkp_slam {

/// Looks whether the records of a ROS 1 bag (format 2.0) and the fields of their headers lie where
/// their lengths say: rosbag itself believes them, and reads past its memory, or asks for
/// gigabytes, where they are wrong. Reads no message. What compressed chunks hold, bags of older
/// formats and those without an index are left to rosbag. Throws `Error`.
void check_bag_records(const std::string& file);

}  // namespace dkp_slam
