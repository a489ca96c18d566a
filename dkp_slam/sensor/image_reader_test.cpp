#include "dkp_slam/sensor/image_reader.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/sensor/jpeg_codec.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(ImageReader, DecodesNoImageLargerThanItsLimit) {
  const fs::path folder = fs::path(::testing::TempDir()) / "image_reader_limit";
  fs::create_directories(folder);
  const cv::Mat image(20, 30, CV_8UC3, cv::Scalar(1, 2, 3));
  for (const char* name : {"image.png", "image.jpg"}) {
    const std::string path = folder / name;
    cv::imwrite(path, image);
    EXPECT_FALSE(ImageReader(600).read_colour(path).image.empty()) << name;
    const ImageRead refused = ImageReader(599).read_colour(path);
    EXPECT_TRUE(refused.image.empty()) << name;
    EXPECT_THAT(refused.problem, HasSubstr("more pixels")) << name;
  }
  fs::remove_all(folder);
}

TEST(ImageReader, HoldsToItsLimitWhereverTheHeaderLies) {
  const cv::Mat image(20, 30, CV_8UC3, cv::Scalar(1, 2, 3));
  std::vector<std::uint8_t> jpeg, png;
  cv::imencode(".jpg", image, jpeg);
  // libjpeg passes over what is no marker.
  jpeg.insert(jpeg.begin() + 20, {0x0A, 0x0A, 0x0A});
  // PNG decoders do so with chunks of no known kind.
  cv::imencode(".png", image, png);
  const std::vector<std::uint8_t> unknown_chunk = {0,   0,   0,    0,    'a',  'a',
                                                   'A', 'a', 0x38, 0x1C, 0xC1, 0xE7};
  png.insert(png.begin() + 8, unknown_chunk.begin(), unknown_chunk.end());
  for (const auto& file : {jpeg, png}) {
    EXPECT_FALSE(ImageReader(600).unchanged_of(file).image.empty());
    const ImageRead refused = ImageReader(599).unchanged_of(file);
    EXPECT_TRUE(refused.image.empty());
    EXPECT_THAT(refused.problem, HasSubstr("more pixels"));
  }
}

TEST(ImageReader, TakesEveryKindOfPng) {
  const fs::path folder = fs::path(::testing::TempDir()) / "image_reader_png";
  fs::create_directories(folder);
  const std::string path = folder / "image.png";
  cv::Mat deep(20, 30, CV_16UC3), alpha(20, 30, CV_8UC4), bits(20, 30, CV_8UC1);
  cv::RNG random(1);
  random.fill(deep, cv::RNG::UNIFORM, 0, 65536);
  random.fill(alpha, cv::RNG::UNIFORM, 0, 256);
  random.fill(bits, cv::RNG::UNIFORM, 0, 2);
  bits *= 255;
  const auto read_back = [&](const cv::Mat& image, const std::vector<int>& options) {
    cv::imwrite(path, image, options);
    return ImageReader().read_colour(path).image;
  };
  cv::Mat expected;
  cv::cvtColor(alpha, expected, cv::COLOR_BGRA2BGR);
  EXPECT_EQ(cv::norm(read_back(alpha, {}), expected, cv::NORM_INF), 0.0);
  cv::cvtColor(bits, expected, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(cv::norm(read_back(bits, {cv::IMWRITE_PNG_BILEVEL, 1}), expected, cv::NORM_INF), 0.0);
  deep.convertTo(expected, CV_8U, 1.0 / 256.0, -0.499);  // the upper byte
  EXPECT_EQ(cv::norm(read_back(deep, {}), expected, cv::NORM_INF), 0.0);
  fs::resize_file(path, fs::file_size(path) / 2);
  EXPECT_THAT(ImageReader().read_colour(path).problem, HasSubstr("PNG"));
  fs::remove_all(folder);
}

TEST(ImageReader, ReadsAJpegAsOpenCvDoes) {
  const fs::path folder = fs::path(::testing::TempDir()) / "image_reader_jpeg";
  fs::create_directories(folder);
  cv::Mat image(48, 64, CV_8UC3), grey;
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {}, 4.0);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  const std::string path = folder / "image.jpg";
  for (const cv::Mat& original : {image, grey}) {
    cv::imwrite(path, original, {cv::IMWRITE_JPEG_QUALITY, 90});
    EXPECT_EQ(cv::norm(ImageReader().read_colour(path).image, cv::imread(path), cv::NORM_INF), 0.0);
    // And what is written is what OpenCV reads.
    const std::vector<std::uint8_t> file = encode_jpeg(original, 95);
    const cv::Mat back = cv::imdecode(file, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(back.type(), original.type());
    EXPECT_LT(cv::norm(back, original, cv::NORM_INF), 32.0);
  }
  fs::remove_all(folder);
}

TEST(ImageReader, TakesNothingButPngAndJpeg) {
  const fs::path folder = fs::path(::testing::TempDir()) / "image_reader_kinds";
  fs::create_directories(folder);
  const cv::Mat image(20, 30, CV_8UC3, cv::Scalar(1, 2, 3));
  for (const char* name : {"image.tiff", "image.bmp", "image.ppm", "image.webp"}) {
    const std::string path = folder / name;
    ASSERT_TRUE(cv::imwrite(path, image)) << name;
    const ImageRead refused = ImageReader().read_colour(path);
    EXPECT_TRUE(refused.image.empty()) << name;
    EXPECT_EQ(refused.problem, "not a PNG or JPEG file") << name;
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace dkp_slam
