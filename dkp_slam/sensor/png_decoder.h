#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

struct libdeflate_decompressor;

namespace dkp_slam {

/// Decodes the PNG kinds of RGB-D data sets about three times as fast as libpng (as Debian builds
/// it), whose cost would be the largest single one of the whole system: libdeflate instead of zlib,
/// and two rows at a time where the rows are Paeth-filtered. Keeps its buffers between calls; one
/// object per thread. Format: W3C "Portable Network Graphics Specification (Second Edition)".
class PngDecoder {
 public:
  enum class Status {
    ok,
    unsupported,  ///< no PNG, or one of a kind left to the general decoder (palette, interlaced...)
    broken,       ///< truncated or damaged; `problem` says how
  };

  /// A file that states more than `most_pixels` is broken, before any memory is taken for them.
  explicit PngDecoder(std::uint64_t most_pixels = std::numeric_limits<std::uint64_t>::max());
  ~PngDecoder();
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  /// `image` becomes CV_8UC1 (8-bit grey), CV_16UC1 (16-bit grey) or CV_8UC3 BGR (8-bit RGB).
  Status decode(std::span<const std::uint8_t> file, cv::Mat* image, std::string* problem);

 private:
  struct Header {
    int width = 0;
    int height = 0;
    int bits = 0;
    int colour_type = 0;
    bool interlaced = false;
  };

  /// Reads the chunks, checks their sums, and joins the compressed data in `packed_`.
  Status read_chunks(std::span<const std::uint8_t> file, Header* header, std::string* problem);

  const std::uint64_t most_pixels_;
  std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> inflater_;
  std::vector<std::uint8_t> packed_;
  std::vector<std::uint8_t> filtered_;  ///< rows of one filter byte and the row's bytes
  std::vector<std::uint8_t> pixels_;    ///< row stride is the row's bytes and `row_padding`
};

}  // namespace dkp_slam
