#pragma once

#include <string>

namespace dkp_slam {

/// JSON as text, `indent` spaces a level, or in one line for -1. Paths and names may hold bytes
/// that are no UTF-8, which JSON must not: a replacement character stands for them.
template <class Json>
std::string json_text(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace dkp_slam
