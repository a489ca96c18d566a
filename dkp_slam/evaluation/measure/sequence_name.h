#pragma once

#include <optional>
#include <string>

namespace dkp_slam {

/// Camera file of a sequence of a benchmark, by the name that it has there:
/// rgbd_dataset_freiburg1_..., rgbd_dataset_freiburg2_..., rgbd_dataset_freiburg3_... (TUM) and
/// rgbd_bonn_... Throws `Error` for every other name: a calibration is not guessed.
std::string camera_file(const std::string& sequence);

/// The paper's name of a sequence.
struct PaperSequence {
  std::string name;        ///< "W/xyz", as in the paper's tables
  bool synthetic = false;  ///< a generated twin, not the recording that the paper measured
};

/// Which of the paper's six sequences this is. `sequence` is the folder's name: TUM's
/// (rgbd_dataset_freiburg3_walking_xyz), short for it (fr3_walking_xyz), or the bare name of a
/// generated twin (walking_xyz). `scenario` is what the folder was generated from, empty for a
/// recording. Nothing for others, parts of sequences (fr3_walking_halfsphere_50) among them.
std::optional<PaperSequence> paper_sequence(const std::string& sequence,
                                            const std::string& scenario);

}  // namespace dkp_slam
