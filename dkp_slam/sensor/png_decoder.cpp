#include "dkp_slam/sensor/png_decoder.h"

#include <algorithm>
#include <new>

#include <libdeflate.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/sensor/pixel_limit.h"
#include "dkp_slam/sensor/png_filters.h"
#include "dkp_slam/sensor/png_format.h"

namespace dkp_slam {
namespace {

using std::uint8_t;

constexpr std::size_t chunk_overhead = 12;  // length, name, sum
// Refuses to reserve gigabytes for a damaged header.
constexpr std::uint32_t largest_side = 16384;

/// Decoded rows to `image`: 16-bit values to the machine's byte order, RGB to BGR.
void copy_out(const uint8_t* pixels, std::size_t stride, cv::Mat* image) {
  for (int y = 0; y < image->rows; ++y, pixels += stride) {
    if (image->type() == CV_8UC3) {
      const cv::Mat row(1, image->cols, CV_8UC3, const_cast<uint8_t*>(pixels));
      cv::Mat out = image->row(y);
      cv::cvtColor(row, out, cv::COLOR_RGB2BGR);
    } else if (image->type() == CV_16UC1) {
      auto* out = image->ptr<std::uint16_t>(y);
      for (int x = 0; x < image->cols; ++x) {
        out[x] = static_cast<std::uint16_t>(pixels[2 * x] << 8 | pixels[2 * x + 1]);
      }
    } else {
      std::copy_n(pixels, image->cols, image->ptr(y));
    }
  }
}

}  // namespace

PngDecoder::PngDecoder(std::uint64_t most_pixels)
    : most_pixels_(most_pixels),
      inflater_(libdeflate_alloc_decompressor(), libdeflate_free_decompressor) {
  if (!inflater_) throw std::bad_alloc();
}

PngDecoder::~PngDecoder() = default;

PngDecoder::Status PngDecoder::read_chunks(std::span<const uint8_t> file, Header* header,
                                           std::string* problem) {
  packed_.clear();
  const auto broken = [problem](const char* what) {
    *problem = what;
    return Status::broken;
  };
  bool has_header = false;
  for (std::size_t at = sizeof(png::signature); at + chunk_overhead <= file.size();) {
    const uint8_t* chunk = file.data() + at;
    const std::size_t length = png::big_endian(chunk);
    if (length > file.size() - at - chunk_overhead) break;
    const std::string name(reinterpret_cast<const char*>(chunk + 4), 4);
    const uint8_t* data = chunk + 8;
    if (libdeflate_crc32(0, chunk + 4, length + 4) != png::big_endian(data + length)) {
      return broken("damaged PNG (checksum)");
    }
    if (name == "IHDR") {
      constexpr std::size_t header_length = 13;
      if (length != header_length) return broken("damaged PNG (header)");
      const std::uint32_t width = png::big_endian(data), height = png::big_endian(data + 4);
      if (width == 0 || height == 0 || width > largest_side || height > largest_side) {
        return broken("damaged PNG (image size)");
      }
      if (has_too_many_pixels(width, height, most_pixels_)) return broken(too_many_pixels);
      *header = {static_cast<int>(width), static_cast<int>(height), data[8], data[9],
                 data[12] != 0};
      has_header = true;
    } else if (name == "IDAT") {
      packed_.insert(packed_.end(), data, data + length);
    } else if (name == "tRNS") {
      return Status::unsupported;  // gives grey and RGB images an alpha channel
    } else if (name == "IEND") {
      return has_header ? Status::ok : broken("damaged PNG (no header)");
    }
    at += length + chunk_overhead;
  }
  return broken("truncated PNG");
}

PngDecoder::Status PngDecoder::decode(std::span<const uint8_t> file, cv::Mat* image,
                                      std::string* problem) {
  if (!png::has_signature(file)) return Status::unsupported;
  Header header;
  if (const Status status = read_chunks(file, &header, problem); status != Status::ok) {
    return status;
  }
  const bool grey =
      header.colour_type == png::colour_grey && (header.bits == 8 || header.bits == 16);
  const bool rgb = header.colour_type == png::colour_rgb && header.bits == 8;
  if (header.interlaced || (!grey && !rgb)) return Status::unsupported;

  const int pixel_bytes = rgb ? 3 : header.bits / 8;
  const std::size_t row_bytes = static_cast<std::size_t>(header.width) * pixel_bytes;
  const std::size_t filtered_bytes = (row_bytes + 1) * header.height;
  filtered_.resize(filtered_bytes + png::row_padding);
  // Without a pointer to the size, less data than expected is an error, as more always is.
  if (libdeflate_zlib_decompress(inflater_.get(), packed_.data(), packed_.size(), filtered_.data(),
                                 filtered_bytes, nullptr) != LIBDEFLATE_SUCCESS) {
    *problem = "damaged PNG (compressed data)";
    return Status::broken;
  }
  pixels_.resize((row_bytes + png::row_padding) * header.height);
  if (!png::undo_filters(filtered_.data(), pixels_.data(), header.height, row_bytes, pixel_bytes)) {
    *problem = "damaged PNG (unknown row filter)";
    return Status::broken;
  }
  image->create(header.height, header.width,
                rgb ? CV_8UC3 : (header.bits == 16 ? CV_16UC1 : CV_8UC1));
  copy_out(pixels_.data(), row_bytes + png::row_padding, image);
  return Status::ok;
}

}  // namespace dkp_slam
