#include "dkp_slam/detection/yolox/onnx_shapes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/detection/yolox/tiny_onnx.h"

namespace dkp_slam {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::string model_of(const std::string& graph) { return tiny_onnx::bytes(7, graph); }

TEST(OnnxInputShape, ReadsFixedAndFreeDimensions) {
  using namespace tiny_onnx;
  EXPECT_THAT(onnx_input_shape(model_of(bytes(11, value_info("x", {1, 3, 416, 640})))),
              ElementsAre(1, 3, 416, 640));
  const std::string named = bytes(2, "batch");  // dim_param
  const std::string shape = bytes(1, named) + bytes(1, number(1, 3));
  const std::string input = bytes(1, "x") + bytes(2, bytes(1, number(1, 1) + bytes(2, shape)));
  EXPECT_THAT(onnx_input_shape(model_of(bytes(11, input))), ElementsAre(-1, 3));
}

TEST(OnnxInputShape, WeightsListedAmongTheInputsDoNotCount) {
  using namespace tiny_onnx;
  EXPECT_THAT(onnx_input_shape(model_of(bytes(5, int64_tensor("w", {1, 2})) +
                                        bytes(11, value_info("w", {2})) +
                                        bytes(11, value_info("x", {1, 3, 32, 32})))),
              ElementsAre(1, 3, 32, 32));
}

TEST(OnnxInputShape, IsEmptyForOtherFiles) {
  using namespace tiny_onnx;
  EXPECT_THAT(onnx_input_shape(""), IsEmpty());
  EXPECT_THAT(onnx_input_shape("this is not a network"), IsEmpty());
  EXPECT_THAT(onnx_input_shape(std::string(100, '\xFF')), IsEmpty());
  const std::string whole = model_of(bytes(11, value_info("x", {1, 3, 32, 32})));
  EXPECT_THAT(onnx_input_shape(whole.substr(0, whole.size() - 5)), IsEmpty());
  EXPECT_THAT(
      onnx_input_shape(model_of(bytes(11, value_info("x", {1})) + bytes(11, value_info("y", {1})))),
      IsEmpty());
}

}  // namespace
}  // namespace dkp_slam
