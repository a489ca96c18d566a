#include "dkp_slam/detection/yolox/yolox_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/detection/yolox/onnx_shapes.h"
#include "dkp_slam/detection/yolox/tiny_onnx.h"
#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::ThrowsMessage;

TEST(CheckShapes, TakesAnyYoloxSizeSquareOrNot) {
  EXPECT_EQ(yolox::check_shapes("m", {1, 3, 416, 416}, {1, 3549, 85}), cv::Size(416, 416));
  EXPECT_EQ(yolox::check_shapes("m", {-1, 3, 640, 640}, {-1, 8400, 85}), cv::Size(640, 640));
  EXPECT_EQ(yolox::check_shapes("m", {1, 3, 32, 64}, {1, 42, 85}), cv::Size(64, 32));
}

TEST(CheckShapes, RefusesOthersNamingBothShapes) {
  EXPECT_THAT(
      [] {
        yolox::check_shapes("m.onnx", {1, 3, 640, 640}, {1, 84, 8400});
      },
      ThrowsMessage<Error>(
          AllOf(HasSubstr("m.onnx"), HasSubstr("[1, 84, 8400]"), HasSubstr("[1, 8400, 85]"))));
  EXPECT_THAT(
      [] {
        yolox::check_shapes("m", {1, 3, -1, -1}, {1, -1, 85});
      },
      ThrowsMessage<Error>(HasSubstr("[1, 3, ?, ?]")));
  EXPECT_THAT(
      [] {
        yolox::check_shapes("m", {1, 3, 224, 224}, {1, 1000});
      },
      ThrowsMessage<Error>(AllOf(HasSubstr("[1, 1000]"), HasSubstr("[1, 1029, 85]"))));
}

std::string square_model(std::uint64_t side) {
  using namespace tiny_onnx;
  return number(1, 4) +
         bytes(7, node("Identity", {"x"}, "between") + node("Identity", {"between"}, "y") +
                      bytes(2, "graph") + bytes(11, value_info("x", {1, 3, side, side})) +
                      bytes(12, value_info("y", {1, 3549, 85})) +
                      bytes(13, value_info("between", {1, 3, side, side})));
}

TEST(CutToImages, ChangesInputAndOutputAndForgetsWhatLiesBetween) {
  const std::string cut = yolox::cut_to_images(square_model(416), {640, 480});
  EXPECT_THAT(onnx_input_shape(cut), ElementsAre(1, 3, 320, 416));
  // 52 x 40 cells of stride 8, a quarter and a sixteenth of that.
  EXPECT_THAT(cut, HasSubstr(tiny_onnx::value_info("y", {1, 2730, 85})));
  EXPECT_THAT(cut, Not(HasSubstr(tiny_onnx::value_info("between", {1, 3, 416, 416}))));
  EXPECT_THAT(cut, HasSubstr(tiny_onnx::node("Identity", {"between"}, "y")));
}

TEST(CutToImages, LeavesAloneWhatNeedsNoCutOrAllowsNone) {
  EXPECT_THAT(yolox::cut_to_images(square_model(416), {}), IsEmpty());
  EXPECT_THAT(yolox::cut_to_images(square_model(416), {300, 300}), IsEmpty());
  EXPECT_THAT(yolox::cut_to_images(square_model(100), {640, 480}), IsEmpty());
  EXPECT_THAT(yolox::cut_to_images("this is not a network", {640, 480}), IsEmpty());
}

}  // namespace
}  // namespace dkp_slam
