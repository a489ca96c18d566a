#pragma once

#include <cstdio>
#include <functional>
#include <memory>
#include <vector>

#include "dkp_slam/tracking/tracker.h"

namespace dkp_slam {

/// The poses of a run's frames, in the order in which they come. All but the newest lie in a file
/// that has no name and goes with the process, so that an hour takes no more memory than a minute.
/// Where no file can be made or the disk is full they stay in memory.
class PoseLog {
 public:
  /// `in_memory`: poses held before they are written out together.
  explicit PoseLog(std::size_t in_memory = 4096) : in_memory_(in_memory) {}

  void add(const TrackedPose& pose);
  void for_each(const std::function<void(const TrackedPose&)>& use) const;
  std::size_t size() const { return written_ + newest_.size(); }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  /// A pose as it lies in the file.
  struct Record {
    double timestamp;
    double rotation[4];  // x, y, z, w
    double translation[3];
    double motion_rotation[4];  // of from_previous; all zero: nothing
    double motion_translation[3];
    int reference_keyframe, landmarks, continues;
  };

  bool write_out();

  const std::size_t in_memory_;
  std::vector<TrackedPose> newest_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t written_ = 0;
  bool stays_in_memory_ = false;
};

}  // namespace dkp_slam
