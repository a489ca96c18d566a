#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "dkp_slam/synth/source.h"

namespace dkp_slam {

/// Throws `Error` unless a generated sequence may be written here: the folder is missing, empty or
/// holds one already, whose files are then replaced; with `force` it may hold anything else, too.
void check_synthetic_folder(const std::filesystem::path& out, bool force);

/// Told how many frames are written; false ends it there.
using SynthProgress = std::function<bool(std::size_t done)>;

/// Writes all frames of a source as a folder (see SequenceWriter) and a description of how they
/// were made, synth.json. `options`: those of the source. Returns the frames that were written.
/// Throws `Error` where one cannot be; the folder then holds those before it, with their lists.
std::size_t write_synthetic_folder(const std::filesystem::path& out,
                                   const SyntheticOptions& options, SyntheticSource& source,
                                   const SynthProgress& go_on);

}  // namespace dkp_slam
