#pragma once

#include <atomic>
#include <filesystem>
#include <memory>

#include "dkp_slam/system/file_observer.h"

namespace dkp_slam::apps {

/// Pictures of what was taken for moving, OUT/overlay/frame_000030.png.
class OverlayWriter : public FileObserver {
 public:
  /// One picture every `every` frames. Makes the folder and removes an earlier run's pictures from
  /// it. Throws `Error` where nothing can be written.
  OverlayWriter(const std::filesystem::path& out, int every);

  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override;
  int pictures() const { return pictures_; }

 private:
  const std::filesystem::path folder_;
  const int every_;
  std::atomic<int> pictures_{0};
};

}  // namespace dkp_slam::apps
