#include <charconv>
#include <string_view>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/kinect/kinect_source.h"

namespace dkp_slam {
namespace {

constexpr std::string_view plain = "kinect", numbered = "kinect:";

}  // namespace

bool is_kinect(const std::string& name) { return name == plain || name.starts_with(numbered); }

int kinect_number(const std::string& name) {
  if (name == plain) return 0;
  if (name.starts_with(numbered)) {
    const std::string_view digits = std::string_view(name).substr(numbered.size());
    int number = -1;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error == std::errc() && end == digits.data() + digits.size() && number >= 0) return number;
  }
  throw Error(name + ": is no Kinect's name; give kinect, or kinect:1 for the second one");
}

}  // namespace dkp_slam
