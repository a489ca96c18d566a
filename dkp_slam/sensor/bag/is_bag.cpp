#include <array>
#include <fstream>
#include <string_view>

#include "dkp_slam/sensor/bag/bag_source.h"

namespace dkp_slam {

bool is_bag(const std::string& file) {
  constexpr std::string_view magic = "#ROSBAG";
  std::array<char, magic.size()> begin{};
  std::ifstream in(file, std::ios::binary);
  return in.read(begin.data(), begin.size()) &&
         std::string_view(begin.data(), begin.size()) == magic;
}

}  // namespace dkp_slam
