#include "dkp_slam/detection/yolox/yolox_decode.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

constexpr int person = 0;
constexpr int chair = 56;
constexpr int tv = 62;

/// An output for a 64x64 input: 64 rows of stride 8, 16 of stride 16, 4 of stride 32, all empty.
struct Output {
  const cv::Size size{64, 64};
  std::vector<float> values =
      std::vector<float>(static_cast<std::size_t>(yolox::row_count(size) * yolox::row_length));

  float* row(int index) { return values.data() + index * yolox::row_length; }
  std::vector<Detection> decode(float factor = 1.0F, cv::Size image = {64, 64}) const {
    return yolox::decode(values.data(), size, factor, image, ClassTable(), {});
  }
};

Detection box(int class_id, float score, const cv::Rect2f& rect) {
  Detection detection;
  detection.class_id = class_id;
  detection.score = score;
  detection.box = rect;
  return detection;
}

TEST(Letterbox, WideImageFillsTheWidthAndIsPaddedBelow) {
  const cv::Mat image(48, 64, CV_8UC3, cv::Scalar(10, 20, 30));
  std::vector<float> planes(3 * 32 * 32, -1.0F);
  cv::Mat scratch;
  EXPECT_FLOAT_EQ(
      yolox::letterbox(image, {32, 32}, yolox::InputLayout::planes, planes.data(), scratch), 0.5F);
  for (int plane = 0; plane < 3; ++plane) {
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        const float expected = y < 24 ? 10.0F * (plane + 1) : yolox::padding;
        ASSERT_EQ(planes[(plane * 32 + y) * 32 + x], expected) << plane << ' ' << y << ' ' << x;
      }
    }
  }
}

TEST(Letterbox, TallImageIsPaddedAtTheRight) {
  const cv::Mat image(64, 32, CV_8UC3, cv::Scalar(1, 2, 3));
  std::vector<float> planes(3 * 64 * 64, -1.0F);
  cv::Mat scratch;
  EXPECT_FLOAT_EQ(
      yolox::letterbox(image, {64, 64}, yolox::InputLayout::planes, planes.data(), scratch), 1.0F);
  EXPECT_EQ(planes[31], 1.0F);
  EXPECT_EQ(planes[32], yolox::padding);
  EXPECT_EQ(planes[3 * 64 * 64 - 1], yolox::padding);
}

TEST(Letterbox, KeepsPixelsOfAnImageThatFits) {
  cv::Mat image(32, 32, CV_8UC3);
  cv::randu(image, 0, 256);
  std::vector<float> planes(3 * 32 * 32);
  cv::Mat scratch;
  yolox::letterbox(image, {32, 32}, yolox::InputLayout::planes, planes.data(), scratch);
  EXPECT_EQ(planes[5 * 32 + 7], image.at<cv::Vec3b>(5, 7)[0]);
  EXPECT_EQ(planes[(2 * 32 + 9) * 32 + 3], image.at<cv::Vec3b>(9, 3)[2]);
}

TEST(Letterbox, PhasesHoldThePlanesPixelsByTwos) {
  for (const cv::Size& shown : {cv::Size(64, 42), cv::Size(42, 64), cv::Size(29, 32)}) {
    cv::Mat image(shown, CV_8UC3), scratch;
    cv::randu(image, 0, 256);
    const cv::Size size(32, 64);
    std::vector<float> planes(3 * 32 * 64, -1.0F), phases(planes);
    const float factor =
        yolox::letterbox(image, size, yolox::InputLayout::planes, planes.data(), scratch);
    EXPECT_EQ(yolox::letterbox(image, size, yolox::InputLayout::phases, phases.data(), scratch),
              factor);
    for (int plane = 0; plane < 3; ++plane) {
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 32; ++x) {
          // Upper left, lower left, upper right, lower right.
          const int channel = 3 * (y % 2 + 2 * (x % 2)) + plane;
          ASSERT_EQ(phases[(channel * 32 + y / 2) * 16 + x / 2], planes[(plane * 64 + y) * 32 + x])
              << plane << ' ' << y << ' ' << x;
        }
      }
    }
  }
}

TEST(Decode, RowCountOfTheOfficialSizes) {
  EXPECT_EQ(yolox::row_count({416, 416}), 3549);
  EXPECT_EQ(yolox::row_count({640, 640}), 8400);
}

TEST(Decode, AddsTheCellAndScalesByTheStride) {
  Output output;
  // Stride 16, row 2, column 1: after the 64 cells of stride 8.
  float* row = output.row(64 + 2 * 4 + 1);
  row[0] = 0.5F;
  row[1] = 0.25F;
  row[2] = std::log(1.5F);
  row[3] = std::log(2.0F);
  row[4] = 0.8F;
  row[5 + person] = 0.5F;
  const std::vector<Detection> found = output.decode();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].class_id, person);
  EXPECT_FLOAT_EQ(found[0].score, 0.4F);
  EXPECT_FLOAT_EQ(found[0].weight, 10.0F);
  // Centre ((1 + 0.5) * 16, (2 + 0.25) * 16) = (24, 36), size (24, 32).
  EXPECT_NEAR(found[0].box.x, 12.0F, 1e-4);
  EXPECT_NEAR(found[0].box.y, 20.0F, 1e-4);
  EXPECT_NEAR(found[0].box.width, 24.0F, 1e-4);
  EXPECT_NEAR(found[0].box.height, 32.0F, 1e-4);
}

TEST(Decode, UndoesTheLetterboxAndClipsToTheImage) {
  Output output;
  float* row = output.row(64 + 16);  // stride 32, top left cell: centre (0, 0), 32 pixels wide
  row[4] = row[5 + person] = 1.0F;
  const std::vector<Detection> found = output.decode(0.1F, {640, 100});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].box.x, 0.0F, 1e-3);
  EXPECT_NEAR(found[0].box.y, 0.0F, 1e-3);
  EXPECT_NEAR(found[0].box.width, 160.0F, 1e-3);
  EXPECT_NEAR(found[0].box.height, 100.0F, 1e-3);
}

TEST(Decode, DropsWeakBoxesAndFixedThings) {
  Output output;
  output.row(0)[4] = output.row(0)[5 + tv] = 1.0F;
  output.row(20)[4] = 0.3F;
  output.row(20)[5 + person] = 0.3F;
  output.row(40)[4] = std::nanf("");
  output.row(40)[5 + person] = 1.0F;
  EXPECT_TRUE(output.decode().empty());
}

TEST(Decode, DropsScoresThatAreNoProbability) {
  Output output;
  for (const auto& [at, score] : {std::pair{0, std::nanf("")}, std::pair{9, INFINITY},
                                  std::pair{18, 1.001F}, std::pair{27, -INFINITY}}) {
    output.row(at)[4] = 1.0F;
    output.row(at)[5 + person] = score;
  }
  EXPECT_TRUE(output.decode().empty());
  output.row(36)[4] = INFINITY;
  output.row(36)[5 + person] = 0.0F;  // makes NaN
  EXPECT_TRUE(output.decode().empty());
}

TEST(Decode, FindsAPersonInARowThatLikesAnotherClassBetter) {
  Output output;
  output.row(0)[4] = 1.0F;
  output.row(0)[5 + tv] = 0.6F;
  output.row(0)[5 + chair] = 0.4F;
  output.row(0)[5 + person] = 0.3F;
  const std::vector<Detection> found = output.decode();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].class_id, chair);
  EXPECT_EQ(found[1].class_id, person);
}

TEST(SuppressOverlaps, StrongestOfAClassWinsAndClassesAreApart) {
  const std::vector<Detection> kept = yolox::suppress_overlaps(
      {box(person, 0.5F, {0, 0, 10, 10}), box(person, 0.9F, {0, 0, 10, 9}),
       box(chair, 0.4F, {0, 0, 10, 10}), box(person, 0.3F, {20, 0, 10, 10})},
      0.45F);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_FLOAT_EQ(kept[0].score, 0.9F);
  EXPECT_EQ(kept[1].class_id, chair);
  EXPECT_FLOAT_EQ(kept[2].score, 0.3F);
}

TEST(SuppressOverlaps, KeepsAnOverlapUpToTheLimit) {
  // Common 50, union 150: IoU 1/3.
  const std::vector<Detection> boxes{box(person, 0.9F, {0, 0, 10, 10}),
                                     box(person, 0.8F, {5, 0, 10, 10})};
  EXPECT_EQ(yolox::suppress_overlaps(boxes, 0.34F).size(), 2U);
  EXPECT_EQ(yolox::suppress_overlaps(boxes, 0.33F).size(), 1U);
}

TEST(FilledPart, HoldsTheLetterboxedImageInSteps) {
  EXPECT_EQ(yolox::filled_part({416, 416}, {640, 480}), cv::Size(416, 320));
  EXPECT_EQ(yolox::filled_part({416, 416}, {480, 640}), cv::Size(320, 416));
  EXPECT_EQ(yolox::filled_part({640, 640}, {1280, 720}), cv::Size(640, 384));  // 360 rows
  EXPECT_EQ(yolox::filled_part({416, 416}, {416, 416}), cv::Size(416, 416));
  EXPECT_EQ(yolox::filled_part({640, 384}, {640, 480}), cv::Size(512, 384));
}

}  // namespace
}  // namespace dkp_slam
