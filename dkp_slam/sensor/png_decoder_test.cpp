#include "dkp_slam/sensor/png_decoder.h"

#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <libdeflate.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace dkp_slam {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put_big_endian(Bytes* out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    out->push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

void put_chunk(Bytes* out, const std::string& name, const Bytes& data) {
  put_big_endian(out, static_cast<std::uint32_t>(data.size()));
  Bytes body(name.begin(), name.end());
  body.insert(body.end(), data.begin(), data.end());
  out->insert(out->end(), body.begin(), body.end());
  put_big_endian(out, libdeflate_crc32(0, body.data(), body.size()));
}

int predictor(int filter, int a, int b, int c) {
  // The specification's own words for Paeth: the neighbour nearest to a + b - c, ties a, b, c.
  const int p = a + b - c;
  const int pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
  switch (filter) {
    case 1:
      return a;
    case 2:
      return b;
    case 3:
      return (a + b) / 2;
    case 4:
      return pa <= pb && pa <= pc ? a : (pb <= pc ? b : c);
    default:
      return 0;
  }
}

/// Encodes an image with the given filter for each row, in turn.
Bytes encode(const cv::Mat& image, const std::vector<int>& filters) {
  const int pixel_bytes = static_cast<int>(image.elemSize());
  std::vector<Bytes> rows;
  for (int y = 0; y < image.rows; ++y) {
    Bytes row(image.ptr(y), image.ptr(y) + image.cols * pixel_bytes);
    for (int x = 0; x < image.cols; ++x) {
      std::uint8_t* pixel = &row[static_cast<std::size_t>(x * pixel_bytes)];
      // RGB, and 16-bit values in big-endian order, in the file.
      if (pixel_bytes == 3) std::swap(pixel[0], pixel[2]);
      if (pixel_bytes == 2) std::swap(pixel[0], pixel[1]);
    }
    rows.push_back(row);
  }
  Bytes filtered;
  const Bytes zeros(rows[0].size(), 0);
  for (std::size_t y = 0; y < rows.size(); ++y) {
    const int filter = filters[y % filters.size()];
    const Bytes& above = y == 0 ? zeros : rows[y - 1];
    filtered.push_back(static_cast<std::uint8_t>(filter));
    for (std::size_t i = 0; i < rows[y].size(); ++i) {
      const bool first = i < static_cast<std::size_t>(pixel_bytes);
      const std::size_t left = i - static_cast<std::size_t>(pixel_bytes);
      const int p = predictor(filter, first ? 0 : rows[y][left], above[i], first ? 0 : above[left]);
      filtered.push_back(static_cast<std::uint8_t>(rows[y][i] - p));
    }
  }
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(6);
  Bytes packed(libdeflate_zlib_compress_bound(compressor, filtered.size()));
  packed.resize(libdeflate_zlib_compress(compressor, filtered.data(), filtered.size(),
                                         packed.data(), packed.size()));
  libdeflate_free_compressor(compressor);

  Bytes file = {0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A};
  Bytes header;
  put_big_endian(&header, static_cast<std::uint32_t>(image.cols));
  put_big_endian(&header, static_cast<std::uint32_t>(image.rows));
  header.push_back(image.depth() == CV_16U ? 16 : 8);
  header.push_back(image.channels() == 3 ? 2 : 0);
  header.insert(header.end(), {0, 0, 0});
  put_chunk(&file, "IHDR", header);
  const auto half = static_cast<std::ptrdiff_t>(packed.size() / 2);
  put_chunk(&file, "IDAT", Bytes(packed.begin(), packed.begin() + half));
  put_chunk(&file, "IDAT", Bytes(packed.begin() + half, packed.end()));
  put_chunk(&file, "IEND", {});
  return file;
}

cv::Mat random_image(int width, int height, int type) {
  cv::Mat image(height, width, type);
  cv::RNG rng(7);
  rng.fill(image, cv::RNG::UNIFORM, 0, CV_MAT_DEPTH(type) == CV_16U ? 65536 : 256);
  // Smooth parts as well: ties of the Paeth predictor occur there only.
  image(cv::Rect(width / 3, 0, width - width / 3, height)).setTo(cv::Scalar::all(77));
  return image;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

TEST(PngDecoder, UndoesEveryFilterOnEveryKindAndSize) {
  PngDecoder decoder;
  const std::vector<std::vector<int>> filters = {
      {0}, {1}, {2}, {3}, {4}, {4, 4, 0, 4, 1, 2, 3}, {4, 4, 4, 2}, {3, 4, 4, 4, 4, 4}};
  for (const int type : {CV_8UC1, CV_16UC1, CV_8UC3}) {
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 6), cv::Size(2, 5), cv::Size(3, 8),
                                cv::Size(4, 9), cv::Size(53, 17)}) {
      const cv::Mat image = random_image(size.width, size.height, type);
      for (const auto& rows : filters) {
        const Bytes file = encode(image, rows);
        // OpenCV agrees that the test's encoder writes what it should.
        ASSERT_TRUE(same(cv::imdecode(file, cv::IMREAD_UNCHANGED), image));
        cv::Mat decoded;
        std::string problem;
        ASSERT_EQ(decoder.decode(file, &decoded, &problem), PngDecoder::Status::ok) << problem;
        EXPECT_TRUE(same(decoded, image)) << type << " " << size << " filter " << rows[0];
      }
    }
  }
}

TEST(PngDecoder, EveryTruncationAndEveryDamagedByteIsFound) {
  PngDecoder decoder;
  const cv::Mat image = random_image(9, 7, CV_8UC3);
  const Bytes whole = encode(image, {4, 1, 4});
  constexpr std::size_t signature_bytes = 8;
  for (std::size_t size = signature_bytes; size < whole.size(); ++size) {
    cv::Mat decoded;
    std::string problem;
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(decoder.decode(part, &decoded, &problem), PngDecoder::Status::broken) << size;
    EXPECT_FALSE(problem.empty());
  }
  for (std::size_t at = signature_bytes; at < whole.size(); ++at) {
    cv::Mat decoded;
    std::string problem;
    Bytes damaged = whole;
    damaged[at] ^= 0x10;
    EXPECT_EQ(decoder.decode(damaged, &decoded, &problem), PngDecoder::Status::broken) << at;
  }
  // None of this spoils the decoder for the next image.
  cv::Mat decoded;
  std::string problem;
  EXPECT_EQ(decoder.decode(whole, &decoded, &problem), PngDecoder::Status::ok);
  EXPECT_TRUE(same(decoded, image));
}

TEST(PngDecoder, RefusesAnUnknownFilterAndDataOfTheWrongLength) {
  PngDecoder decoder;
  cv::Mat decoded;
  std::string problem;
  const cv::Mat image = random_image(9, 7, CV_16UC1);
  EXPECT_EQ(decoder.decode(encode(image, {4, 5}), &decoded, &problem), PngDecoder::Status::broken);
  // A header that promises one row more or less than there is.
  for (const int change : {-1, 1}) {
    Bytes file = encode(image, {4});
    Bytes header(file.begin() + 16, file.begin() + 29);
    header[7] = static_cast<std::uint8_t>(header[7] + change);
    Bytes other(file.begin(), file.begin() + 8);
    put_chunk(&other, "IHDR", header);
    other.insert(other.end(), file.begin() + 33, file.end());
    EXPECT_EQ(decoder.decode(other, &decoded, &problem), PngDecoder::Status::broken);
  }
}

TEST(PngDecoder, LeavesOtherKindsToTheGeneralDecoder) {
  PngDecoder decoder;
  cv::Mat decoded;
  std::string problem;
  Bytes file;
  cv::imencode(".png", random_image(9, 7, CV_8UC4), file);
  EXPECT_EQ(decoder.decode(file, &decoded, &problem), PngDecoder::Status::unsupported);
  cv::imencode(".jpg", random_image(9, 7, CV_8UC3), file);
  EXPECT_EQ(decoder.decode(file, &decoded, &problem), PngDecoder::Status::unsupported);
  EXPECT_EQ(decoder.decode({}, &decoded, &problem), PngDecoder::Status::unsupported);
}

}  // namespace
}  // namespace dkp_slam
