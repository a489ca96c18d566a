#pragma once

#include <algorithm>

namespace dkp_slam {

/// The item with this id among those in ascending order; null where none has it. By searching: how
/// many ids there are may be a mere number in a file, how many items is its length.
template <class Items>
auto find_id(const Items& ascending, int id) -> decltype(ascending.data()) {
  const auto end = ascending.data() + ascending.size();
  const auto it = std::lower_bound(ascending.data(), end, id,
                                   [](const auto& item, int wanted) { return item.id < wanted; });
  return it != end && it->id == id ? it : nullptr;
}

}  // namespace dkp_slam
