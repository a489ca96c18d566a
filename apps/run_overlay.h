#pragma once

#include <atomic>
#include <filesystem>
#include <memory>

#include "apps/observer_failure.h"
#include "dkp_slam/system/observer.h"

namespace dkp_slam::apps {

/// Pictures of what was taken for moving, OUT/overlay/frame_000030.png.
class OverlayWriter : public SlamObserver {
 public:
  /// One picture every `every` frames. Makes the folder and removes an earlier run's pictures from
  /// it. Throws `Error` where nothing can be written.
  OverlayWriter(const std::filesystem::path& out, int every);

  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override;
  int pictures() const { return pictures_; }
  /// Throws what kept a picture from being written, if anything did.
  void rethrow_failure() const { failure_.rethrow(); }

 private:
  const std::filesystem::path folder_;
  const int every_;
  std::atomic<int> pictures_{0};
  ObserverFailure failure_;
};

}  // namespace dkp_slam::apps
