#include "dkp_slam/sensor/png_decoder.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>

#include <libdeflate.h>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/sensor/png_format.h"

namespace dkp_slam {
namespace {

using std::uint8_t;

constexpr std::size_t chunk_overhead = 12;  // length, name, sum
// Pixels are loaded and stored four bytes at a time, whatever their size.
constexpr std::size_t row_padding = 4;
// Refuses to reserve gigabytes for a damaged header.
constexpr std::uint32_t largest_side = 16384;

enum Filter : uint8_t { none = 0, sub = 1, up = 2, average = 3, paeth = 4 };

unsigned load_pixel(const uint8_t* p) {
  unsigned value = 0;
  std::memcpy(&value, p, sizeof(value));
  return value;
}

uint8_t paeth_predictor(int a, int b, int c) {
  const int pa = std::abs(b - c);
  const int pb = std::abs(a - c);
  const int pc = std::abs(a + b - 2 * c);
  const int nearer = pb <= pc ? b : c;
  return static_cast<uint8_t>(pa <= pb && pa <= pc ? a : nearer);
}

/// Undoes one row's filter. `in` is the filtered row, `prior` the decoded row above.
template <int pixel_bytes>
void unfilter_row(Filter filter, const uint8_t* in, const uint8_t* prior, uint8_t* out,
                  std::size_t bytes) {
  switch (filter) {
    case none:
      std::memcpy(out, in, bytes);
      return;
    case sub:
      std::memcpy(out, in, pixel_bytes);
      for (std::size_t i = pixel_bytes; i < bytes; ++i) {
        out[i] = static_cast<uint8_t>(in[i] + out[i - pixel_bytes]);
      }
      return;
    case up:
      for (std::size_t i = 0; i < bytes; ++i) out[i] = static_cast<uint8_t>(in[i] + prior[i]);
      return;
    case average:
      for (std::size_t i = 0; i < bytes; ++i) {
        const int left = i < pixel_bytes ? 0 : out[i - pixel_bytes];
        out[i] = static_cast<uint8_t>(in[i] + (left + prior[i]) / 2);
      }
      return;
    case paeth:
      for (std::size_t i = 0; i < bytes; ++i) {
        const int left = i < pixel_bytes ? 0 : out[i - pixel_bytes];
        const int upper_left = i < pixel_bytes ? 0 : prior[i - pixel_bytes];
        out[i] = static_cast<uint8_t>(in[i] + paeth_predictor(left, prior[i], upper_left));
      }
      return;
  }
}

/// Two Paeth rows at once. Every pixel waits for its left neighbour, which makes one row a chain of
/// latencies; the row below runs one pixel behind in the upper half of the same vectors, for free.
template <int pixel_bytes>
void unfilter_paeth_pair(const uint8_t* in0, const uint8_t* in1, const uint8_t* prior,
                         uint8_t* out0, uint8_t* out1, std::size_t pixels) {
  using cv::v_int16x8;
  const auto widen = [](unsigned low, unsigned high) {
    cv::v_uint16x8 narrow, unused;
    cv::v_expand(cv::v_reinterpret_as_u8(cv::v_uint32x4(low, high, 0U, 0U)), narrow, unused);
    return cv::v_reinterpret_as_s16(narrow);
  };
  const v_int16x8 low_byte = cv::v_setall_s16(0xFF);
  v_int16x8 a = cv::v_setzero_s16();  // left
  v_int16x8 c = cv::v_setzero_s16();  // upper left
  const auto step = [&](unsigned input0, unsigned input1, unsigned prior0) {
    // What lies above the lower row's pixel is what the upper row put out one step ago.
    const v_int16x8 b = widen(prior0, 0U) | cv::v_rotate_left<4>(a);
    const v_int16x8 from_b = b - c;
    const v_int16x8 from_a = a - c;
    const auto magnitude = [](const v_int16x8& v) { return cv::v_max(v, cv::v_setzero_s16() - v); };
    const v_int16x8 pa = magnitude(from_b);
    const v_int16x8 pb = magnitude(from_a);
    const v_int16x8 pc = magnitude(from_a + from_b);
    const v_int16x8 least = cv::v_min(pc, cv::v_min(pa, pb));
    const v_int16x8 predicted = cv::v_select(least == pa, a, cv::v_select(least == pb, b, c));
    a = (widen(input0, input1) + predicted) & low_byte;
    c = b;
    return cv::v_reinterpret_as_u64(cv::v_pack_u(a, a)).get0();
  };
  const auto store = [](uint8_t* out, std::uint64_t value) {
    const auto pixel = static_cast<unsigned>(value);
    std::memcpy(out, &pixel, sizeof(pixel));
  };
  store(out0, step(load_pixel(in0), 0U, load_pixel(prior)));
  for (std::size_t x = 1; x < pixels; ++x) {
    const std::size_t at = x * pixel_bytes;
    const std::uint64_t both =
        step(load_pixel(in0 + at), load_pixel(in1 + at - pixel_bytes), load_pixel(prior + at));
    store(out0 + at, both);
    store(out1 + at - pixel_bytes, both >> 32);
  }
  const std::size_t last = (pixels - 1) * pixel_bytes;
  store(out1 + last, step(0U, load_pixel(in1 + last), 0U) >> 32);
}

/// All rows; false when a row names a filter that does not exist.
template <int pixel_bytes>
bool unfilter(const uint8_t* in, uint8_t* out, int height, std::size_t row_bytes) {
  const std::vector<uint8_t> zeros(row_bytes + row_padding, 0);
  const std::size_t in_stride = row_bytes + 1;
  const std::size_t out_stride = row_bytes + row_padding;
  const uint8_t* prior = zeros.data();
  for (int y = 0; y < height; ++y, in += in_stride, prior = out, out += out_stride) {
    if (in[0] > paeth) return false;
    if (in[0] == paeth && y + 1 < height && in[in_stride] == paeth) {
      unfilter_paeth_pair<pixel_bytes>(in + 1, in + in_stride + 1, prior, out, out + out_stride,
                                       row_bytes / pixel_bytes);
      in += in_stride;
      out += out_stride;
      ++y;
      continue;
    }
    unfilter_row<pixel_bytes>(static_cast<Filter>(in[0]), in + 1, prior, out, row_bytes);
  }
  return true;
}

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

PngDecoder::PngDecoder()
    : inflater_(libdeflate_alloc_decompressor(), libdeflate_free_decompressor) {
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
  filtered_.resize(filtered_bytes + row_padding);
  // Without a pointer to the size, less data than expected is an error, as more always is.
  if (libdeflate_zlib_decompress(inflater_.get(), packed_.data(), packed_.size(), filtered_.data(),
                                 filtered_bytes, nullptr) != LIBDEFLATE_SUCCESS) {
    *problem = "damaged PNG (compressed data)";
    return Status::broken;
  }
  pixels_.resize((row_bytes + row_padding) * header.height);
  const auto unfilter_all = rgb ? unfilter<3> : (pixel_bytes == 2 ? unfilter<2> : unfilter<1>);
  if (!unfilter_all(filtered_.data(), pixels_.data(), header.height, row_bytes)) {
    *problem = "damaged PNG (unknown row filter)";
    return Status::broken;
  }
  image->create(header.height, header.width,
                rgb ? CV_8UC3 : (header.bits == 16 ? CV_16UC1 : CV_8UC1));
  copy_out(pixels_.data(), row_bytes + row_padding, image);
  return Status::ok;
}

}  // namespace dkp_slam
