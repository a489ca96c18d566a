#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

namespace dkp_slam {

/// Pairs two kinds of messages that come mixed, each kind in the order of its stamps: a depth image
/// goes to the colour image nearest to it, less than `max_difference` (seconds) away, each used
/// once.
template <class Message>
class StampPairing {
 public:
  /// Messages of a kind that wait at most: where one kind is far behind the other, the oldest go.
  static constexpr std::size_t most_waiting = 150;

  explicit StampPairing(double max_difference) : most_(max_difference) {}

  void add_colour(double stamp, Message message) { add(colour_, stamp, std::move(message)); }
  void add_depth(double stamp, Message message) { add(depth_, stamp, std::move(message)); }
  /// No more will come.
  void end() { ended_ = true; }
  /// Images of colour that found no partner.
  std::size_t unpaired() const { return unpaired_; }

  struct Pair {
    double colour_stamp, depth_stamp;  ///< seconds
    Message colour, depth;
  };
  /// The next pair; nothing when more messages must come before it can be told. With `settle` what
  /// is there is all there is for now.
  std::optional<Pair> next(bool settle = false) {
    while (!colour_.empty()) {
      const double stamp = colour_.front().first;
      while (!depth_.empty() && depth_.front().first <= stamp - most_) depth_.pop_front();
      // The nearest may still come, and so may a colour image that is nearer to it.
      if (!ended_ && !(settle && !depth_.empty()) && !same_stamp(stamp) && undecided(stamp)) {
        return std::nullopt;
      }
      const std::size_t chosen = nearest_to(stamp);
      if (chosen == depth_.size()) {
        colour_.pop_front();
        ++unpaired_;
        continue;
      }
      Pair pair{stamp, depth_[chosen].first, std::move(colour_.front().second),
                std::move(depth_[chosen].second)};
      colour_.pop_front();
      depth_.erase(depth_.begin(), depth_.begin() + static_cast<std::ptrdiff_t>(chosen) + 1);
      return pair;
    }
    return std::nullopt;
  }

 private:
  /// Nothing can be nearer.
  bool same_stamp(double stamp) const {
    return std::any_of(depth_.begin(), depth_.end(),
                       [stamp](const auto& depth) { return depth.first == stamp; });
  }
  bool undecided(double stamp) const {
    return depth_.empty() || depth_.back().first < stamp + most_ ||
           (colour_.size() < 2 && depth_.back().first < stamp + 2.0 * most_);
  }
  using Queue = std::deque<std::pair<double, Message>>;

  void add(Queue& queue, double stamp, Message message) {
    // What goes back in time has no place any more.
    if (!queue.empty() && stamp <= queue.back().first) return;
    queue.emplace_back(stamp, std::move(message));
    if (queue.size() <= most_waiting) return;
    if (&queue == &colour_) ++unpaired_;
    queue.pop_front();
  }

  /// Index of the depth image for the first colour image; their number where there is none.
  std::size_t nearest_to(double stamp) const {
    std::size_t best = depth_.size();
    for (std::size_t i = 0; i < depth_.size() && depth_[i].first < stamp + most_; ++i) {
      const double distance = std::abs(depth_[i].first - stamp);
      const bool of_next =
          colour_.size() > 1 && std::abs(colour_[1].first - depth_[i].first) < distance;
      if (of_next) break;
      if (best == depth_.size() || distance < std::abs(depth_[best].first - stamp)) best = i;
    }
    return best;
  }

  const double most_;
  Queue colour_, depth_;
  bool ended_ = false;
  std::size_t unpaired_ = 0;
};

}  // namespace dkp_slam
