#include "dkp_slam/sensor/png_encoder.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>

#include <libdeflate.h>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/png_format.h"

namespace dkp_slam {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t filter_up = 2;
constexpr std::size_t chunk_head = 8, chunk_sum = 4;

void put_big_endian(std::uint32_t value, std::uint8_t* out) {
  for (int i = 0; i < 4; ++i) out[i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
}

/// Length and name in front of a chunk's data, which stands at `chunk` + 8 already, its sum behind.
void finish_chunk(std::string_view name, std::size_t data_size, std::uint8_t* chunk) {
  put_big_endian(static_cast<std::uint32_t>(data_size), chunk);
  std::memcpy(chunk + 4, name.data(), 4);
  put_big_endian(libdeflate_crc32(0, chunk + 4, 4 + data_size), chunk + chunk_head + data_size);
}

/// A row in the file's order of bytes: red first, the higher of two first.
void order_bytes(const cv::Mat& image, int y, std::uint8_t* out) {
  const auto* in = image.ptr<std::uint8_t>(y);
  const auto pixel_bytes = static_cast<int>(image.elemSize());
  if (pixel_bytes == 1) std::copy_n(in, image.cols, out);
  for (int x = 0; pixel_bytes == 2 && x < image.cols; ++x) {
    const std::uint16_t value = image.at<std::uint16_t>(y, x);
    out[2 * x] = static_cast<std::uint8_t>(value >> 8U);
    out[2 * x + 1] = static_cast<std::uint8_t>(value);
  }
  for (int x = 0; pixel_bytes == 3 && x < image.cols; ++x) {
    out[3 * x] = in[3 * x + 2];
    out[3 * x + 1] = in[3 * x + 1];
    out[3 * x + 2] = in[3 * x];
  }
}

/// Rows of a filter byte and the differences from the row above.
Bytes filtered(const cv::Mat& image) {
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  Bytes above(row_bytes, 0), row(row_bytes);
  Bytes out(static_cast<std::size_t>(image.rows) * (row_bytes + 1));
  for (int y = 0; y < image.rows; ++y) {
    order_bytes(image, y, row.data());
    std::uint8_t* to = out.data() + static_cast<std::size_t>(y) * (row_bytes + 1);
    *to++ = filter_up;
    for (std::size_t i = 0; i < row_bytes; ++i) {
      to[i] = static_cast<std::uint8_t>(row[i] - above[i]);
    }
    std::swap(row, above);
  }
  return out;
}

}  // namespace

Bytes encode_png(const cv::Mat& image, PngSize size) {
  const int type = image.type();
  if (image.empty() || (type != CV_8UC1 && type != CV_16UC1 && type != CV_8UC3)) {
    throw Error("PNG: only 8-bit grey, 16-bit grey and 8-bit colour images can be written");
  }
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> deflater(
      libdeflate_alloc_compressor(size == PngSize::fast ? 1 : 9), libdeflate_free_compressor);
  if (!deflater) throw std::bad_alloc();
  const Bytes rows = filtered(image);
  const std::size_t most = libdeflate_zlib_compress_bound(deflater.get(), rows.size());
  constexpr std::size_t header_size = 13;
  constexpr std::size_t data_at = sizeof(png::signature) + chunk_head + header_size + chunk_sum;
  Bytes file(data_at + 2 * (chunk_head + chunk_sum) + most);
  std::memcpy(file.data(), png::signature, sizeof(png::signature));
  std::uint8_t* header = file.data() + sizeof(png::signature) + chunk_head;
  put_big_endian(static_cast<std::uint32_t>(image.cols), header);
  put_big_endian(static_cast<std::uint32_t>(image.rows), header + 4);
  header[8] = type == CV_16UC1 ? 16 : 8;  // bits; the rest: no choices, not interlaced
  header[9] = type == CV_8UC3 ? png::colour_rgb : png::colour_grey;
  finish_chunk("IHDR", header_size, file.data() + sizeof(png::signature));
  const std::size_t packed = libdeflate_zlib_compress(deflater.get(), rows.data(), rows.size(),
                                                      file.data() + data_at + chunk_head, most);
  finish_chunk("IDAT", packed, file.data() + data_at);
  const std::size_t end_at = data_at + chunk_head + packed + chunk_sum;
  finish_chunk("IEND", 0, file.data() + end_at);
  file.resize(end_at + chunk_head + chunk_sum);
  return file;
}

}  // namespace dkp_slam
