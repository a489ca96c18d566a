#include "dkp_slam/sensor/png_encoder.h"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/png_decoder.h"

namespace dkp_slam {
namespace {

cv::Mat random_image(int type, double highest) {
  cv::Mat image(37, 53, type);
  cv::RNG rng(type + 1);
  rng.fill(image, cv::RNG::UNIFORM, 0.0, highest);
  // Both runs and noise.
  image.rowRange(5, 20).setTo(cv::Scalar::all(0.7 * highest));
  return image;
}

class EncodePngKinds : public ::testing::TestWithParam<int> {};

TEST_P(EncodePngKinds, ComesBackThroughLibpngAndThroughOurDecoder) {
  const cv::Mat image = random_image(GetParam(), GetParam() == CV_16UC1 ? 65536.0 : 256.0);
  // A view into a larger image has gaps between its rows.
  for (const cv::Mat& of : {image, image(cv::Rect(3, 4, 31, 30))}) {
    const std::vector<std::uint8_t> file = encode_png(of);
    const cv::Mat general = cv::imdecode(file, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(general.type(), of.type());
    ASSERT_EQ(general.size(), of.size());
    EXPECT_EQ(cv::norm(general, of, cv::NORM_INF), 0.0);
    PngDecoder decoder;
    cv::Mat ours;
    std::string problem;
    ASSERT_EQ(decoder.decode(file, &ours, &problem), PngDecoder::Status::ok) << problem;
    EXPECT_EQ(cv::norm(ours, of, cv::NORM_INF), 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EncodePngKinds, ::testing::Values(CV_8UC1, CV_16UC1, CV_8UC3));

TEST(EncodePng, IsSmallWhereNothingHappens) {
  EXPECT_LT(encode_png(cv::Mat(480, 640, CV_8UC1, cv::Scalar(3))).size(), 2000U);
}

TEST(EncodePng, RefusesOtherImages) {
  EXPECT_THROW(encode_png(cv::Mat()), Error);
  EXPECT_THROW(encode_png(cv::Mat(4, 4, CV_32FC1)), Error);
}

}  // namespace
}  // namespace dkp_slam
