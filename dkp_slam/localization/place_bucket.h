#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

namespace dkp_slam {

/// One bucket of a place index's tables: entries with 32 further bits of their descriptors, in no
/// order. Eight bytes while it is empty, as most of half a million are: a vector takes 24.
class PlaceBucket {
 public:
  struct Slot {
    std::uint32_t signature;
    std::int32_t entry;
  };

  std::span<const Slot> slots() const {
    return block_ ? std::span<const Slot>(&block_[1], count()) : std::span<const Slot>();
  }

  void insert(const Slot& slot) {
    const std::uint32_t used = block_ ? count() : 0;
    if (used == room()) resize(std::max(2U, 2 * used));
    block_[1 + used] = slot;
    ++block_[0].signature;
  }

  /// Takes out the slot of an entry, which the bucket holds.
  void erase(std::int32_t entry) {
    const auto first = &block_[1];
    const std::uint32_t left = count() - 1;
    *std::find_if(first, first + left, [&](const Slot& s) { return s.entry == entry; }) =
        first[left];
    block_[0].signature = left;
    // Descriptors come and go all over the tables: buckets that kept their memory would end up with
    // many times what is in them.
    if (left == 0) {
      block_.reset();
    } else if (room() > 2 && 4 * left <= room()) {
      resize(std::max(2U, left));
    }
  }

  /// On the heap, bytes.
  std::size_t memory() const { return block_ ? (1 + room()) * sizeof(Slot) : 0; }

 private:
  std::uint32_t count() const { return block_[0].signature; }
  std::uint32_t room() const { return block_ ? static_cast<std::uint32_t>(block_[0].entry) : 0; }

  void resize(std::uint32_t room) {
    auto block = std::make_unique_for_overwrite<Slot[]>(1 + room);
    const auto held = slots();
    std::copy(held.begin(), held.end(), &block[1]);
    block[0] = {static_cast<std::uint32_t>(held.size()), static_cast<std::int32_t>(room)};
    block_ = std::move(block);
  }

  std::unique_ptr<Slot[]> block_;  // the first: how many there are, and for how many there is room
};

}  // namespace dkp_slam
