#pragma once

#include <filesystem>

#include "dkp_slam/dynamics/frame_dynamics.h"
#include "dkp_slam/system/front_end.h"

namespace dkp_slam::apps {

/// Pictures of what was taken for moving, OUT/overlay/frame_000030.png.
class OverlayWriter {
 public:
  /// One picture every `every` frames. Makes the folder and removes an earlier run's pictures from
  /// it. Throws `Error` where nothing can be written.
  OverlayWriter(const std::filesystem::path& out, int every);

  bool wants(int frame_index) const { return frame_index % every_ == 0; }
  /// Throws `Error` when the picture cannot be written.
  void write(const PreparedFrame& prepared, const FrameDynamics& dynamics);
  int pictures() const { return pictures_; }

 private:
  const std::filesystem::path folder_;
  const int every_;
  int pictures_ = 0;
};

}  // namespace dkp_slam::apps
