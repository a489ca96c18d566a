#pragma once

#include <string>
#include <utility>
#include <vector>

namespace dkp_slam {

/// One line of rgb.txt or depth.txt.
struct StampedFile {
  double timestamp = 0.0;  ///< seconds
  std::string path;        ///< as written, relative to the list's folder
};

/// A colour image and the depth image that belongs to it.
struct ImagePair {
  double timestamp = 0.0;  ///< seconds, of the colour image
  std::string colour;      ///< path as written in the list
  std::string depth;
  double depth_timestamp = 0.0;  ///< seconds
  /// The depth image whose stamp is nearest, where a known delay made `depth` another; else empty.
  std::string stamped_depth;
};

/// Reads "timestamp path" lines; '#' begins a comment; commas and tabs count as spaces. The result
/// is sorted by time stamp: lines out of order, and repeated time stamps (the first is kept), give
/// a warning. Throws `Error` with file and line on any other line.
std::vector<StampedFile> read_stamped_files(const std::string& list);

/// Reads the four columns of an associations file, in either order: the depth image is the one
/// whose path names depth. Sorted and made unique by the colour image's time stamp as above.
std::vector<ImagePair> read_associations(const std::string& list);

/// Pairs of indices (a, b) whose time stamps lie less than `max_difference` (seconds) apart, each
/// index used at most once, the nearest pairs first; sorted by a. Same result as associate.py of
/// the TUM RGB-D benchmark. Both inputs must be sorted.
std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<double>& a,
                                                           const std::vector<double>& b,
                                                           double max_difference);

}  // namespace dkp_slam
