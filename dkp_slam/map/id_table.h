#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace dkp_slam {

/// Values by id, for ids that are given in turn, never twice, and mostly do not stay, as those of
/// landmarks: nine in ten go within seconds. Ids lie in pages, and a page in which none is left is
/// used again for others, so that memory follows the number of values; what an id leaves behind for
/// ever is an eighth of a byte.
template <class T>
class IdTable {
 public:
  /// Null where there is none.
  const T* find(int id) const {
    const std::int32_t p = page_of(id);
    if (p < 0) return nullptr;
    const Page& page = pages_[static_cast<std::size_t>(p)];
    return page.used >> (id % page_size) & 1U ? &page.values[at(id)] : nullptr;
  }
  T* find(int id) { return const_cast<T*>(std::as_const(*this).find(id)); }

  /// Only where there is one.
  const T& operator[](int id) const {
    assert(find(id));
    return pages_[static_cast<std::size_t>(page_of(id))].values[at(id)];
  }
  T& operator[](int id) { return const_cast<T&>(std::as_const(*this)[id]); }

  /// Enters a value or replaces it.
  T& set(int id, T value) {
    const auto which = static_cast<std::size_t>(id) / page_size;
    if (which >= directory_.size()) directory_.resize(which + 1, none);
    if (directory_[which] == none) directory_[which] = empty_page();
    Page& page = pages_[static_cast<std::size_t>(directory_[which])];
    const std::uint32_t bit = 1U << (id % page_size);
    size_ += (page.used & bit) == 0;
    page.used |= bit;
    return page.values[at(id)] = std::move(value);
  }

  /// Nothing happens where there is none.
  void erase(int id) {
    if (!find(id)) return;
    std::int32_t& p = directory_[static_cast<std::size_t>(id) / page_size];
    Page& page = pages_[static_cast<std::size_t>(p)];
    page.values[at(id)] = T();
    page.used &= ~(1U << (id % page_size));
    --size_;
    if (page.used != 0) return;
    free_.push_back(p);
    p = none;
  }

  std::size_t size() const { return size_; }

  /// Of all values, ascending.
  std::vector<int> ids() const {
    std::vector<int> all;
    all.reserve(size_);
    for (std::size_t which = 0; which < directory_.size(); ++which) {
      if (directory_[which] == none) continue;
      const std::uint32_t used = pages_[static_cast<std::size_t>(directory_[which])].used;
      for (int i = 0; i < page_size; ++i) {
        if (used >> i & 1U) all.push_back(static_cast<int>(which) * page_size + i);
      }
    }
    return all;
  }

  /// The first id that has a value, counted from this one on; -1 for none.
  int next(int id) const {
    for (auto which = static_cast<std::size_t>(id) / page_size; which < directory_.size();
         ++which, id = static_cast<int>(which) * page_size) {
      if (directory_[which] == none) continue;
      const std::uint32_t left =
          pages_[static_cast<std::size_t>(directory_[which])].used >> (id % page_size);
      if (left != 0) return id + std::countr_zero(left);
    }
    return -1;
  }

  /// Bytes on the heap, without what the values hold there themselves.
  std::size_t memory() const {
    return (directory_.capacity() + free_.capacity()) * sizeof(std::int32_t) +
           pages_.capacity() * sizeof(Page);
  }

 private:
  static constexpr int page_size = 32;
  static constexpr std::int32_t none = -1;
  struct Page {
    std::uint32_t used = 0;  // a bit for each value
    std::array<T, page_size> values{};
  };

  static std::size_t at(int id) { return static_cast<std::size_t>(id) % page_size; }
  std::int32_t page_of(int id) const {
    const auto which = static_cast<std::size_t>(id) / page_size;
    return which < directory_.size() ? directory_[which] : none;
  }
  std::int32_t empty_page() {
    if (free_.empty()) {
      pages_.emplace_back();
      return static_cast<std::int32_t>(pages_.size()) - 1;
    }
    const std::int32_t p = free_.back();
    free_.pop_back();
    return p;
  }

  std::vector<std::int32_t> directory_;  // by id / page_size: index into pages_
  std::vector<Page> pages_;
  std::vector<std::int32_t> free_;  // empty pages
  std::size_t size_ = 0;
};

}  // namespace dkp_slam
