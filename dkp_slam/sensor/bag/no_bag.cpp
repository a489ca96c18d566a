// Stands in where rosbag is not installed.
#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/bag/bag_source.h"

namespace dkp_slam {

bool can_read_bags() { return false; }

std::unique_ptr<BagSource> open_bag(const std::string& file, const BagOptions&) {
  throw Error(fmt::format(
      "{}: this program was built without rosbag; install it with `scripts/setup.sh --with ros` "
      "(librosbag-storage-dev) and build again",
      file));
}

}  // namespace dkp_slam
