#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "dkp_slam/detection/class_table.h"
#include "dkp_slam/detection/detector.h"

namespace dkp_slam {

/// A detector that repeats what a file says: an earlier run's detections, somebody else's network,
/// or exact boxes. The file is text, one detection a line: `timestamp class_id score x y width
/// height`, seconds of the colour image's stamp (to the microsecond), COCO class from 0 (-2: moves
/// and has no name), pixels; lines that begin with # are comments, but for `# timestamp not looked
/// at`: the detector gave no answer about that image. All other images without a line are answered:
/// nobody there. Weights come from `classes`.
/// Throws `Error` that names file and line when the file cannot be read or a line is wrong.
std::unique_ptr<Detector> open_recorded_detections(const std::filesystem::path& file,
                                                   const ClassTable& classes);

/// Lines of such a file for one frame's detections. Silhouettes are not recorded.
std::string recorded_lines(double timestamp, const std::vector<Detection>& detections);
/// The line of a frame that the detector did not look at.
std::string recorded_gap(double timestamp);

/// The file's first line: what the columns are.
std::string recorded_header();

}  // namespace dkp_slam
