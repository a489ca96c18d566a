#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace dkp_slam {

/// Values by id, for the few ids that one call meets out of all that were ever given: time and
/// memory follow those few, not the map. (IdTable keeps what belongs to the ids for good.)
/// Open addressing with linear probing; ids are 0 or more. No order, and nothing can be taken out.
template <class T>
class IdMap {
 public:
  /// Null where the id has not been entered. Holds until the next `insert`.
  T* find(int id) {
    Slot& slot = slots_[slot_of(id)];
    return slot.id == id ? &slot.value : nullptr;
  }
  const T* find(int id) const { return const_cast<IdMap*>(this)->find(id); }
  bool contains(int id) const { return find(id) != nullptr; }

  /// The id's value, and true where it is this one; one that was entered before stays.
  std::pair<T&, bool> insert(int id, T value = T()) {
    assert(id >= 0);
    std::size_t s = slot_of(id);
    if (slots_[s].id == id) return {slots_[s].value, false};
    if (2 * (size_ + 1) > slots_.size()) {
      grow();
      s = slot_of(id);
    }
    ++size_;
    slots_[s] = {id, std::move(value)};
    return {slots_[s].value, true};
  }

  std::size_t size() const { return size_; }

 private:
  static constexpr std::int32_t none = -1;
  struct Slot {
    std::int32_t id = none;
    T value{};
  };

  /// Where the id is, or would be entered. Fibonacci hashing: ids in a row fall far apart.
  std::size_t slot_of(int id) const {
    const std::size_t last = slots_.size() - 1;
    std::size_t s = (static_cast<std::uint32_t>(id) * std::uint64_t{2654435769U} >> 16) & last;
    while (slots_[s].id != none && slots_[s].id != id) s = (s + 1) & last;
    return s;
  }
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (Slot& slot : old) {
      if (slot.id != none) slots_[slot_of(slot.id)] = std::move(slot);
    }
  }

  std::vector<Slot> slots_ = std::vector<Slot>(64);  // a power of two, at most half of them used
  std::size_t size_ = 0;
};

/// Ids met so far.
class IdSet {
 public:
  /// True where the id is new.
  bool insert(int id) { return ids_.insert(id).second; }
  bool contains(int id) const { return ids_.contains(id); }

 private:
  IdMap<char> ids_;
};

}  // namespace dkp_slam
