// PNG files against libpng, through OpenCV: what our decoder takes, libpng decodes to the same.
#include <libdeflate.h>
#include <opencv2/imgcodecs.hpp>

#include "dkp_slam/sensor/png_decoder.h"
#include "dkp_slam/sensor/png_encoder.h"
#include "dkp_slam/sensor/png_format.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

constexpr std::size_t chunk_overhead = 12;  // length, name, sum
constexpr std::uint64_t most_pixels = 1'000'000;

void put_big_endian(std::uint32_t value, std::uint8_t* to) {
  for (int i = 0; i < 4; ++i) to[i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
}

/// Gives each chunk the sum that belongs to it: no mutation would find those.
void mend_sums(std::vector<std::uint8_t>& file) {
  for (std::size_t at = sizeof(png::signature); at + chunk_overhead <= file.size();) {
    const std::size_t length = png::big_endian(&file[at]);
    if (length > file.size() - at - chunk_overhead) return;
    put_big_endian(libdeflate_crc32(0, &file[at + 4], length + 4), &file[at + 8 + length]);
    at += length + chunk_overhead;
  }
}

void add_chunk(std::vector<std::uint8_t>& file, const char* name, Bytes data) {
  const std::size_t at = file.size();
  file.resize(at + chunk_overhead);
  put_big_endian(static_cast<std::uint32_t>(data.size()), &file[at]);
  std::copy_n(name, 4, &file[at + 4]);
  file.insert(file.begin() + static_cast<std::ptrdiff_t>(at) + 8, data.begin(), data.end());
}

/// A file whose rows, as they are before compression, are the input: any filters on any values.
std::vector<std::uint8_t> file_of_rows(Reader& input) {
  const int width = 1 + input.below(40), height = 1 + input.below(24), kind = input.below(3);
  const std::size_t pixel_bytes = kind == 0 ? 1 : (kind == 1 ? 2 : 3);
  std::vector<std::uint8_t> header(13);
  put_big_endian(static_cast<std::uint32_t>(width), &header[0]);
  put_big_endian(static_cast<std::uint32_t>(height), &header[4]);
  header[8] = kind == 1 ? 16 : 8;
  header[9] = kind == 2 ? png::colour_rgb : png::colour_grey;
  std::vector<std::uint8_t> rows;
  for (int y = 0; y < height; ++y) {
    rows.push_back(static_cast<std::uint8_t>(input.below(5)));
    for (std::size_t x = 0; x < static_cast<std::size_t>(width) * pixel_bytes; ++x) {
      rows.push_back(input.take<std::uint8_t>());
    }
  }
  std::vector<std::uint8_t> packed(rows.size() + 1024);
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(1);
  packed.resize(
      libdeflate_zlib_compress(compressor, rows.data(), rows.size(), packed.data(), packed.size()));
  libdeflate_free_compressor(compressor);
  std::vector<std::uint8_t> file(std::begin(png::signature), std::end(png::signature));
  add_chunk(file, "IHDR", header);
  add_chunk(file, "IDAT", packed);
  add_chunk(file, "IEND", {});
  mend_sums(file);
  return file;
}

std::uint64_t stated_pixels(const std::vector<std::uint8_t>& file) {
  if (file.size() < 24) return 0;
  return std::uint64_t{png::big_endian(&file[16])} * png::big_endian(&file[20]);
}

void run(Bytes bytes) {
  Reader input(bytes);
  const int kind = input.below(3);
  std::vector<std::uint8_t> file;
  if (kind == 0) {
    file = file_of_rows(input);
  } else {
    file.assign(input.rest().begin(), input.rest().end());
    if (kind == 1) mend_sums(file);
  }
  if (stated_pixels(file) > most_pixels) return;  // the reader before it refuses them
  static PngDecoder decoder;
  cv::Mat image;
  std::string problem;
  const PngDecoder::Status status = decoder.decode(file, &image, &problem);
  require(kind != 0 || status == PngDecoder::Status::ok, "a good file is refused");
  require((status == PngDecoder::Status::broken) != problem.empty(), "problem and status differ");
  if (status != PngDecoder::Status::ok) return;
  cv::Mat reference;
  try {
    reference = cv::imdecode(file, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
  }
  if (reference.empty() && kind != 0) return;  // libpng looks at chunks that we pass over
  require(reference.type() == image.type() && reference.size() == image.size(),
          "libpng decodes it to another type or size");
  require(cv::norm(image, reference, cv::NORM_INF) == 0.0, "libpng decodes it to other pixels");
}

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  for (const int type : {CV_8UC1, CV_16UC1, CV_8UC3}) {
    cv::Mat image(7, 9, type);
    cv::RNG(type + 1).fill(image, cv::RNG::UNIFORM, 0, 255);
    const std::vector<std::uint8_t> file = encode_png(image);
    all.push_back('\1' + std::string(file.begin(), file.end()));
    std::vector<std::uint8_t> other;
    cv::imencode(".png", image, other);
    all.push_back('\2' + std::string(other.begin(), other.end()));
  }
  for (const char kind : {'\0', '\1', '\2'}) {
    std::string rows{'\0', '\30', '\10', kind};
    for (int i = 0; i < 500; ++i) rows += static_cast<char>(i * 37 % 251);
    all.push_back(rows);
  }
  return all;
}

const Registration registration({"png", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
