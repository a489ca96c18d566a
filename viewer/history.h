#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace dkp_slam::viewer {

/// Values by the number of their frame, oldest first, within a budget: when it is used up, every
/// second one of the older half goes. So all of a run stays, what is long ago in wider steps.
template <class T>
class ThinnedHistory {
 public:
  struct Entry {
    int frame = 0;
    std::size_t size = 1;
    T value;
  };

  explicit ThinnedHistory(std::size_t budget) : budget_(budget) {}

  /// `frame` is above all others; `size` in the budget's unit.
  void add(int frame, T value, std::size_t size = 1) {
    entries_.push_back({frame, size, std::move(value)});
    used_ += size;
    while (used_ > budget_ && entries_.size() > 3) thin();
  }
  void clear() {
    entries_.clear();
    used_ = 0;
  }

  const std::vector<Entry>& entries() const { return entries_; }
  std::vector<Entry>& entries() { return entries_; }
  std::size_t used() const { return used_; }

  /// The first one after this frame.
  typename std::vector<Entry>::const_iterator after(int frame) const {
    return std::upper_bound(entries_.begin(), entries_.end(), frame,
                            [](int f, const Entry& e) { return f < e.frame; });
  }
  /// That of this frame, or the last one before it; null where there is none.
  const Entry* at(int frame) const {
    const auto next = after(frame);
    return next == entries_.begin() ? nullptr : &*(next - 1);
  }

 private:
  void thin() {
    const std::size_t half = std::max<std::size_t>(2, entries_.size() / 2);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (i < half && i % 2 == 1) {
        used_ -= entries_[i].size;
        continue;
      }
      if (kept != i) entries_[kept] = std::move(entries_[i]);
      ++kept;
    }
    entries_.resize(kept);
  }

  const std::size_t budget_;
  std::size_t used_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace dkp_slam::viewer
