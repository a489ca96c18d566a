#pragma once

#include <stdexcept>
#include <string>

namespace dkp_slam {

/// The one exception type that leaves the library. The message is one line: what is wrong, where
/// (file, line or field), and what to do about it.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace dkp_slam
