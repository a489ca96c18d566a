#include "dkp_slam/sensor/image_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <memory>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/sensor/png_format.h"

namespace dkp_slam {
namespace {

/// Whole file into `bytes`; false, with errno set, when it cannot be read.
bool read_file(const std::string& path, std::vector<std::uint8_t>* bytes) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (!file || std::fseek(file.get(), 0, SEEK_END) != 0) return false;
  const long size = std::ftell(file.get());
  if (size < 0 || std::fseek(file.get(), 0, SEEK_SET) != 0) return false;
  bytes->resize(static_cast<std::size_t>(size));
  return std::fread(bytes->data(), 1, bytes->size(), file.get()) == bytes->size();
}

/// OpenCV fills up what is missing of a JPEG file with grey and calls it read. A whole one ends
/// with the marker FF D9; some cameras append a few bytes.
bool is_truncated_jpeg(const std::vector<std::uint8_t>& file) {
  constexpr std::uint8_t start[] = {0xFF, 0xD8, 0xFF};
  constexpr std::uint8_t end[] = {0xFF, 0xD9};
  constexpr std::ptrdiff_t tail = 1024;
  if (file.size() < sizeof(start) || !std::equal(start, start + 3, file.begin())) return false;
  const auto from = file.end() - std::min(tail, std::ssize(file));
  return std::search(from, file.end(), end, end + 2) == file.end();
}

/// Why a file is no PNG of 8-bit grey values, by its first bytes; empty when it is one.
std::string no_grey_png(const std::vector<std::uint8_t>& file) {
  constexpr std::size_t bits_at = 24, colour_type_at = 25;  // in the header chunk, always the first
  if (file.size() <= colour_type_at ||
      !std::equal(std::begin(png::signature), std::end(png::signature), file.begin())) {
    return "not a PNG file";
  }
  const int bits = file[bits_at], colour_type = file[colour_type_at];
  if (bits == 8 && colour_type == png::colour_grey) return "";
  return "not of 8-bit grey values but of " + (colour_type == png::colour_grey
                                                   ? std::to_string(bits) + " bits"
                                                   : std::string("colours"));
}

}  // namespace

ImageRead ImageReader::read(const std::string& path, int opencv_flags) {
  if (!read_file(path, &file_)) return {{}, std::strerror(errno)};
  if (file_.empty()) return {{}, "the file is empty"};
  return decode(opencv_flags);
}

ImageRead ImageReader::decode(int opencv_flags) {
  ImageRead result;
  switch (png_.decode(file_, &result.image, &result.problem)) {
    case PngDecoder::Status::ok:
    case PngDecoder::Status::broken:
      return result;
    case PngDecoder::Status::unsupported:
      break;
  }
  if (is_truncated_jpeg(file_)) return {{}, "truncated JPEG"};
  try {
    result.image = cv::imdecode(file_, opencv_flags);
  } catch (const cv::Exception& error) {
    return {{}, error.err};
  }
  if (result.image.empty()) result.problem = "not an image that can be read";
  return result;
}

ImageRead ImageReader::read_colour(const std::string& path) {
  // The lens model belongs to the image as stored, so no turning by what the file says of the top.
  ImageRead result = read(path, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
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

ImageRead ImageReader::read_unchanged(const std::string& path) {
  return read(path, cv::IMREAD_UNCHANGED);
}

ImageRead ImageReader::read_grey_png(const std::string& path) {
  if (!read_file(path, &file_)) return {{}, std::strerror(errno)};
  if (const std::string problem = no_grey_png(file_); !problem.empty()) return {{}, problem};
  return decode(cv::IMREAD_UNCHANGED);
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

}  // namespace dkp_slam
