#include "dkp_slam/sensor/png_filters.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif
#include <opencv2/core/hal/intrin.hpp>

#include "dkp_slam/cpu.h"

namespace dkp_slam::png {
namespace {

using std::uint8_t;

enum Filter : uint8_t { none = 0, sub = 1, up = 2, average = 3, paeth = 4 };

unsigned load_pixel(const uint8_t* p) {
  unsigned value = 0;
  std::memcpy(&value, p, sizeof(value));
  return value;
}

void store_pixel(uint8_t* out, std::uint64_t value) {
  const auto pixel = static_cast<unsigned>(value);
  std::memcpy(out, &pixel, sizeof(pixel));
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
  store_pixel(out0, step(load_pixel(in0), 0U, load_pixel(prior)));
  for (std::size_t x = 1; x < pixels; ++x) {
    const std::size_t at = x * pixel_bytes;
    const std::uint64_t both =
        step(load_pixel(in0 + at), load_pixel(in1 + at - pixel_bytes), load_pixel(prior + at));
    store_pixel(out0 + at, both);
    store_pixel(out1 + at - pixel_bytes, both >> 32);
  }
  const std::size_t last = (pixels - 1) * pixel_bytes;
  store_pixel(out1 + last, step(0U, load_pixel(in1 + last), 0U) >> 32);
}

#if defined(__x86_64__)
/// Four Paeth rows at once, the same way, where the machine has vectors of 256 bits.
struct PaethRows {
  __m256i left, upper_left;
};

/// Pixels of the four rows, a row's after the one above it in the next lane; `prior` is above the
/// first. Returns those of rows 0 and 1 in the lower 64 bits, of 2 and 3 in the bits from 128 on.
DKP_SLAM_AVX2 inline __m256i paeth_step(PaethRows& rows, __m128i input, unsigned prior) {
  const __m256i above = _mm256_permute4x64_epi64(rows.left, _MM_SHUFFLE(2, 1, 0, 0));
  const __m128i first = _mm_cvtepu8_epi16(_mm_cvtsi32_si128(static_cast<int>(prior)));
  const __m256i b = _mm256_blend_epi32(above, _mm256_castsi128_si256(first), 0b11);
  const __m256i from_b = _mm256_sub_epi16(b, rows.upper_left);
  const __m256i from_a = _mm256_sub_epi16(rows.left, rows.upper_left);
  const __m256i pa = _mm256_abs_epi16(from_b);
  const __m256i pb = _mm256_abs_epi16(from_a);
  const __m256i pc = _mm256_abs_epi16(_mm256_add_epi16(from_a, from_b));
  const __m256i least = _mm256_min_epi16(pc, _mm256_min_epi16(pa, pb));
  const __m256i b_or_c = _mm256_blendv_epi8(rows.upper_left, b, _mm256_cmpeq_epi16(least, pb));
  const __m256i predicted = _mm256_blendv_epi8(b_or_c, rows.left, _mm256_cmpeq_epi16(least, pa));
  rows.left = _mm256_and_si256(_mm256_add_epi16(_mm256_cvtepu8_epi16(input), predicted),
                               _mm256_set1_epi16(0xFF));
  rows.upper_left = b;
  return _mm256_packus_epi16(rows.left, rows.left);
}

template <int pixel_bytes>
DKP_SLAM_AVX2 void unfilter_paeth_four(const uint8_t* in, std::size_t in_stride,
                                       const uint8_t* prior, uint8_t* out, std::size_t out_stride,
                                       std::size_t pixels) {
  PaethRows rows{_mm256_setzero_si256(), _mm256_setzero_si256()};
  constexpr std::size_t lag = 3;  // of the last row behind the first
  for (std::size_t x = 0; x < pixels + lag; ++x) {
    const bool all = x >= lag && x < pixels;
    unsigned input[4] = {};
    for (std::size_t r = 0; r < 4; ++r) {
      if (all || (x >= r && x - r < pixels)) {
        input[r] = load_pixel(in + r * in_stride + (x - r) * pixel_bytes);
      }
    }
    const __m128i inputs = _mm_set_epi32(static_cast<int>(input[3]), static_cast<int>(input[2]),
                                         static_cast<int>(input[1]), static_cast<int>(input[0]));
    const __m256i done =
        paeth_step(rows, inputs, x < pixels ? load_pixel(prior + x * pixel_bytes) : 0U);
    const auto upper = static_cast<std::uint64_t>(_mm256_extract_epi64(done, 0));
    const auto lower = static_cast<std::uint64_t>(_mm256_extract_epi64(done, 2));
    const std::uint64_t output[4] = {upper, upper >> 32, lower, lower >> 32};
    for (std::size_t r = 0; r < 4; ++r) {
      if (all || (x >= r && x - r < pixels)) {
        store_pixel(out + r * out_stride + (x - r) * pixel_bytes, output[r]);
      }
    }
  }
}
#endif

/// How many rows from `in` on are Paeth's, `most` at most.
int paeth_rows(const uint8_t* in, std::size_t stride, int most) {
  int rows = 0;
  while (rows < most && in[static_cast<std::size_t>(rows) * stride] == paeth) ++rows;
  return rows;
}

/// Undoes the first of `left` rows, and those after it that can be undone with it; returns how
/// many.
template <int pixel_bytes>
int unfilter_rows(const uint8_t* in, const uint8_t* prior, uint8_t* out, int left,
                  std::size_t row_bytes) {
  const std::size_t in_stride = row_bytes + 1, out_stride = row_bytes + row_padding;
  const std::size_t pixels = row_bytes / pixel_bytes;
  const int alike = paeth_rows(in, in_stride, std::min(4, left));
#if defined(__x86_64__)
  if (alike == 4 && have_avx2()) {
    unfilter_paeth_four<pixel_bytes>(in + 1, in_stride, prior, out, out_stride, pixels);
    return 4;
  }
#endif
  if (alike >= 2) {
    unfilter_paeth_pair<pixel_bytes>(in + 1, in + in_stride + 1, prior, out, out + out_stride,
                                     pixels);
    return 2;
  }
  unfilter_row<pixel_bytes>(static_cast<Filter>(in[0]), in + 1, prior, out, row_bytes);
  return 1;
}

/// All rows; false when a row names a filter that does not exist.
template <int pixel_bytes>
bool unfilter(const uint8_t* in, uint8_t* out, int height, std::size_t row_bytes) {
  const std::vector<uint8_t> zeros(row_bytes + row_padding, 0);
  const uint8_t* prior = zeros.data();
  for (int y = 0; y < height;) {
    if (in[0] > paeth) return false;
    const int rows = unfilter_rows<pixel_bytes>(in, prior, out, height - y, row_bytes);
    in += static_cast<std::size_t>(rows) * (row_bytes + 1);
    out += static_cast<std::size_t>(rows) * (row_bytes + row_padding);
    prior = out - (row_bytes + row_padding);
    y += rows;
  }
  return true;
}

}  // namespace

bool undo_filters(const uint8_t* in, uint8_t* out, int height, std::size_t row_bytes,
                  int pixel_bytes) {
  switch (pixel_bytes) {
    case 1:
      return unfilter<1>(in, out, height, row_bytes);
    case 2:
      return unfilter<2>(in, out, height, row_bytes);
    default:
      return unfilter<3>(in, out, height, row_bytes);
  }
}

}  // namespace dkp_slam::png
