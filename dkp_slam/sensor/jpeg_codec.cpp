#include "dkp_slam/sensor/jpeg_codec.h"

#include <algorithm>
#include <memory>
#include <new>

#include <fmt/format.h>
#include <turbojpeg.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/pixel_limit.h"

namespace dkp_slam {
namespace {

using Handle = std::unique_ptr<void, int (*)(tjhandle)>;

Handle owned(tjhandle handle) {
  if (handle == nullptr) throw std::bad_alloc();
  return {handle, tjDestroy};
}

}  // namespace

bool is_jpeg(std::span<const std::uint8_t> file) {
  constexpr std::uint8_t start[] = {0xFF, 0xD8, 0xFF};
  return file.size() >= sizeof(start) && std::equal(start, start + sizeof(start), file.begin());
}

bool decode_jpeg(std::span<const std::uint8_t> file, std::uint64_t most_pixels, cv::Mat* image,
                 std::string* problem) {
  const Handle handle = owned(tjInitDecompress());
  const auto failed = [&](int status) {
    // Most of what the library calls a warning is none: it fills up with grey what is missing.
    const std::string reason = status == 0 ? "" : tjGetErrorStr2(handle.get());
    if (status == 0 || reason.find("extraneous bytes") != std::string::npos) return false;
    *problem = fmt::format("damaged JPEG ({})", reason);
    image->release();
    return true;
  };
  int width = 0, height = 0, subsampling = 0, colours = 0;
  if (failed(tjDecompressHeader3(handle.get(), file.data(), file.size(), &width, &height,
                                 &subsampling, &colours))) {
    return false;
  }
  if (has_too_many_pixels(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height),
                          most_pixels)) {
    *problem = too_many_pixels;
    return false;
  }
  image->create(height, width, CV_8UC3);
  // Hundreds of scans in a small file would take minutes.
  constexpr int flags = TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS;
  return !failed(tjDecompress2(handle.get(), file.data(), file.size(), image->data, width,
                               static_cast<int>(image->step), height, TJPF_BGR, flags));
}

std::vector<std::uint8_t> encode_jpeg(const cv::Mat& image, int quality) {
  const bool grey = image.type() == CV_8UC1;
  if (image.empty() || (!grey && image.type() != CV_8UC3)) {
    throw Error("JPEG: only 8-bit grey and 8-bit colour images can be written");
  }
  const Handle handle = owned(tjInitCompress());
  const int subsampling = grey ? TJSAMP_GRAY : TJSAMP_420;
  std::vector<std::uint8_t> file(tjBufSize(image.cols, image.rows, subsampling));
  unsigned char* out = file.data();
  unsigned long size = file.size();
  if (tjCompress2(handle.get(), image.data, image.cols, static_cast<int>(image.step), image.rows,
                  grey ? TJPF_GRAY : TJPF_BGR, &out, &size, subsampling, quality,
                  TJFLAG_NOREALLOC) != 0) {
    throw Error(fmt::format("JPEG: an image cannot be encoded: {}", tjGetErrorStr2(handle.get())));
  }
  file.resize(size);
  return file;
}

}  // namespace dkp_slam
