#pragma once

#include <concepts>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"

namespace dkp_slam {

/// The whole number of that name in a JSON object. Throws `Error` for any other and for one that
/// `Integer` does not hold, which the JSON library converts all the same.
template <std::integral Integer, class Json>
Integer integer_at(const Json& object, const char* name) {
  const Json& value = object.at(name);
  const bool held =
      value.is_number_unsigned()
          ? std::in_range<Integer>(value.template get<std::uint64_t>())
          : value.is_number_integer() && std::in_range<Integer>(value.template get<std::int64_t>());
  if (!held) throw Error(fmt::format("'{}' is no whole number in its range", name));
  return value.template get<Integer>();
}

}  // namespace dkp_slam
