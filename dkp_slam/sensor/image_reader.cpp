#include "dkp_slam/sensor/image_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <limits>
#include <memory>
#include <span>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/input_file.h"
#include "dkp_slam/sensor/jpeg_codec.h"
#include "dkp_slam/sensor/png_format.h"
#include "dkp_slam/sensor/png_general.h"

namespace dkp_slam {
namespace {

constexpr std::uintmax_t most_bytes = 256'000'000;

/// Whole file into `bytes`. Returns what is in the way, or nothing.
std::string read_file(const std::string& path, std::vector<std::uint8_t>* bytes) {
  if (std::string problem = why_unreadable(path, most_bytes); !problem.empty()) return problem;
  errno = 0;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (!file || std::fseek(file.get(), 0, SEEK_END) != 0) return std::strerror(errno);
  const long size = std::ftell(file.get());
  if (size < 0 || std::fseek(file.get(), 0, SEEK_SET) != 0) return std::strerror(errno);
  bytes->resize(static_cast<std::size_t>(size));
  if (std::fread(bytes->data(), 1, bytes->size(), file.get()) == bytes->size()) return "";
  return errno != 0 ? std::strerror(errno) : "it became shorter while it was read";
}

/// Why a file is no PNG of 8-bit grey values, by its first bytes; empty when it is one.
std::string no_grey_png(const std::vector<std::uint8_t>& file) {
  constexpr std::size_t bits_at = 24, colour_type_at = 25;  // in the header chunk, always the first
  if (!png::has_signature(file) || file.size() <= colour_type_at) return "not a PNG file";
  const int bits = file[bits_at], colour_type = file[colour_type_at];
  if (bits == 8 && colour_type == png::colour_grey) return "";
  return "not of 8-bit grey values but of " + (colour_type == png::colour_grey
                                                   ? std::to_string(bits) + " bits"
                                                   : std::string("colours"));
}

}  // namespace

ImageRead ImageReader::read_unchanged(const std::string& path) {
  if (std::string problem = read_file(path, &file_); !problem.empty()) return {{}, problem};
  if (file_.empty()) return {{}, "the file is empty"};
  return decode();
}

ImageRead ImageReader::unchanged_of(std::span<const std::uint8_t> file) {
  file_.assign(file.begin(), file.end());
  if (file_.empty()) return {{}, "there are no data"};
  return decode();
}

ImageRead ImageReader::decode() {
  ImageRead result;
  switch (png_.decode(file_, &result.image, &result.problem)) {
    case PngDecoder::Status::ok:
    case PngDecoder::Status::broken:
      return result;
    case PngDecoder::Status::unsupported:
      break;
  }
  if (is_jpeg(file_)) {
    decode_jpeg(file_, most_pixels_, &result.image, &result.problem);
  } else if (png::has_signature(file_)) {
    decode_any_png(file_, most_pixels_, &result.image, &result.problem);
  } else {
    result.problem = "not a PNG or JPEG file";
  }
  return result;
}

ImageRead ImageReader::read_colour(const std::string& path) {
  ImageRead result = read_unchanged(path);
  if (result.image.empty()) return result;
  if (result.image.depth() == CV_16U) {
    constexpr double to_byte = 1.0 / 257.0;
    result.image.convertTo(result.image, CV_8U, to_byte);
  }
  if (result.image.channels() == 1) {
    cv::cvtColor(result.image, result.image, cv::COLOR_GRAY2BGR);
  }
  return result;
}

ImageRead ImageReader::read_grey_png(const std::string& path) {
  if (std::string problem = read_file(path, &file_); !problem.empty()) return {{}, problem};
  if (const std::string problem = no_grey_png(file_); !problem.empty()) return {{}, problem};
  return decode();
}

cv::Mat depth_in_metres(const cv::Mat& raw, double units_per_metre, double min_depth,
                        double max_depth) {
  CV_Assert(raw.type() == CV_16UC1);
  cv::Mat metres(raw.size(), CV_32FC1);
  const auto scale = static_cast<float>(units_per_metre);
  const auto nearest = static_cast<float>(min_depth);
  const auto farthest = static_cast<float>(max_depth);
  for (int y = 0; y < raw.rows; ++y) {
    const auto* in = raw.ptr<std::uint16_t>(y);
    auto* out = metres.ptr<float>(y);
    for (int x = 0; x < raw.cols; ++x) {
      const float depth = static_cast<float>(in[x]) / scale;
      // One bit-and instead of two branches lets the compiler make vectors of it.
      const bool known = (depth >= nearest) & (depth <= farthest);
      out[x] = known ? depth : 0.0F;
    }
  }
  return metres;
}

void keep_depth_range(cv::Mat& metres, double min_depth, double max_depth) {
  CV_Assert(metres.type() == CV_32FC1);
  const auto nearest = static_cast<float>(min_depth);
  const auto farthest = static_cast<float>(max_depth);
  for (int y = 0; y < metres.rows; ++y) {
    for (float& depth : std::span(metres.ptr<float>(y), static_cast<std::size_t>(metres.cols))) {
      if (!(depth >= nearest && depth <= farthest)) depth = 0.0F;
    }
  }
}

cv::Mat depth_in_units(const cv::Mat& metres, double units_per_metre) {
  CV_Assert(metres.type() == CV_32FC1);
  cv::Mat units;
  metres.convertTo(units, CV_16U, units_per_metre);
  constexpr auto most = std::numeric_limits<std::uint16_t>::max();
  // What was cut to the largest number is not that far away.
  units.setTo(0, metres > (most + 0.5) / units_per_metre);
  return units;
}

}  // namespace dkp_slam
