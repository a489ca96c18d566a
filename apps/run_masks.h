#pragma once

#include <filesystem>
#include <string>

#include "dkp_slam/system/file_observer.h"

namespace dkp_slam::apps {

/// Folder of a run that holds its masks.
inline constexpr const char* masks_folder = "masks";

/// File name of the mask of the image of a time stamp, seconds.
std::string mask_name(double timestamp);

/// Removes what an earlier run kept in the folder of a run, so that nothing of it is taken for the
/// new one's. Throws `Error`.
void remove_masks(const std::filesystem::path& out);

/// Keeps what was taken for moving, OUT/masks/TIMESTAMP.png for every frame: 8-bit grey, 255 on
/// what moves, for `--masks` of this and other programs.
class MaskWriter : public FileObserver {
 public:
  /// Makes the folder; what is in it from before is gone. Throws `Error` where nothing can be
  /// written.
  explicit MaskWriter(const std::filesystem::path& out);

  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override;

 private:
  const std::filesystem::path folder_;
};

}  // namespace dkp_slam::apps
