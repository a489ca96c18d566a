#pragma once

#include <cstddef>

namespace dkp_slam {

/// Stands for the value of any field; for unevaluated use alone.
struct AnyField {
  template <class Field>
  operator Field() const noexcept;
};

/// How many fields an aggregate has (its own; those of a field that is a struct count as one).
template <class Aggregate, class... Fields>
consteval std::size_t field_count() {
  if constexpr (requires { Aggregate{Fields{}..., AnyField{}}; }) {
    return field_count<Aggregate, Fields..., AnyField>();
  } else {
    return sizeof...(Fields);
  }
}

}  // namespace dkp_slam
