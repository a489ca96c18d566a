#pragma once

#include <filesystem>
#include <map>

#include "dkp_slam/system/observer.h"

namespace dkp_slam::apps {

/// The path of a run that may be killed: each pose as it was known when its frame was done, in TUM
/// format in OUT/trajectory.live.txt, and at once. Poses of another map, whose world is another,
/// go to trajectory_2.live.txt and so on, in the order in which the maps are met. When the run has
/// saved its own, adjusted path these go.
///
/// Takes the newest frame, so that a slow disk costs poses and no time; what cannot be written is
/// said once and does not end the run. Against a kill, not against a loss of power.
class LivePath : public SlamObserver {
 public:
  /// Removes what an earlier run has left there.
  explicit LivePath(std::filesystem::path out);
  ~LivePath() override;
  LivePath(const LivePath&) = delete;
  LivePath& operator=(const LivePath&) = delete;

  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override;
  /// After the run: removes the files.
  void remove();

 private:
  std::filesystem::path name(std::size_t number) const;
  /// Opens the file of a map's path when it is first needed; negative where it cannot be.
  int descriptor_of(int map);
  void warn();

  const std::filesystem::path out_;
  std::map<int, int> descriptors_;  // by map
  bool warned_ = false;
};

}  // namespace dkp_slam::apps
