#pragma once

#include <optional>
#include <string>

namespace dkp_slam {

/// Camera file of a sequence, by its name: fr1, fr2, fr3 (freiburg1 to 3), composites are on fr1,
/// bonn. Throws `Error` for a name that says nothing.
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
