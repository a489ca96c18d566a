#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/system/frame_result.h"

namespace dkp_slam::apps {

/// Median time of a stage over the frames of a run.
struct StageMedian {
  std::string stage;
  double ms = 0.0;
};

/// What a run writes about every frame: timings.csv, a line per frame and a column per stage, and
/// detections.txt. It goes to the disk as it comes, so that an hour takes no more memory than a
/// minute, and shows in the folder once it is saved.
class RunLog {
 public:
  explicit RunLog(const std::filesystem::path& folder);

  /// `memory_mb`: of the whole process.
  void add(const FrameResult& frame, double memory_mb);
  void add(double timestamp, const DetectionResult& answer);
  /// Of each stage, 0 without frames, that of the detector over the images that it looked at; in
  /// the order of the columns, the whole frame last.
  std::vector<StageMedian> medians();
  /// Throws `Error` where something could not be written, now or before.
  void save();

 private:
  GrowingFile timings_, detections_;
  bool answered_ = false;  // the detector, at least once
};

}  // namespace dkp_slam::apps
