#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "dkp_slam/dense/live/live_dense_map.h"

namespace dkp_slam::viewer {

/// The dense map that a run fuses, as a cloud for pages: made when somebody asks, once for all.
/// Each function may be called by any thread.
class FusedCloud {
 public:
  static constexpr std::size_t most_points = 150'000;

  explicit FusedCloud(std::shared_ptr<LiveDenseMap> map) : map_(std::move(map)) {}

  /// Rises with every change that is fused; 0: nothing is yet.
  long version() const { return map_->version(); }
  /// Of one of the atlas' maps, as a Container: version in the head, sections positions (3 float32
  /// each, metres in the map's world frame) and colours (3 uint8, red, green, blue). At most two
  /// seconds old; null where nothing is fused.
  std::shared_ptr<const std::string> cloud(int map);

 private:
  using Clock = std::chrono::steady_clock;

  const std::shared_ptr<LiveDenseMap> map_;
  std::mutex mutex_;  // of what follows
  std::shared_ptr<const std::string> made_;
  std::pair<int, long> made_of_{-1, -1};  // map, version
  Clock::time_point next_{};
};

}  // namespace dkp_slam::viewer
