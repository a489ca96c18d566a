#include "dkp_slam/detection/yolox/onnx_focus.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/detection/yolox/onnx_shapes.h"
#include "dkp_slam/detection/yolox/tiny_onnx.h"

namespace dkp_slam {
namespace {

using namespace tiny_onnx;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::string rest = node("Identity", {"dealt"}, "y");
const std::string image = bytes(11, value_info("image", {1, 3, 64, 32}));
const std::string ends = image + bytes(12, value_info("y", {1, 12, 32, 16}));

std::string concat(const std::vector<std::string>& parts, std::uint64_t side = 1) {
  return node("Concat", parts, "dealt", axis(side));
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

TEST(OnnxWithoutFocus, TakesTheDealtImageAsItsInput) {
  const std::string left = onnx_without_focus(
      model(focus() + rest + ends + bytes(13, value_info("upper", {1, 3, 32, 32}))));
  EXPECT_THAT(onnx_input_shape(left), ElementsAre(1, 12, 32, 16));
  EXPECT_THAT(left, HasSubstr(value_info("dealt", {1, 12, 32, 16})));
  EXPECT_THAT(left, HasSubstr(rest));
  for (const char* gone : {"image", "upper", "lower", "Slice", "Concat"}) {
    EXPECT_THAT(left, Not(HasSubstr(gone)));
  }
  EXPECT_THAT(left, HasSubstr(bytes(8, number(2, 11))));  // the operator set
}

TEST(OnnxWithoutFocus, NumbersMayBePackedAndEndsJustReachTheEdge) {
  std::string graph = focus() + rest + ends;
  const std::string packed = number(1, 1) + number(2, 7) + bytes(7, varint(64)) + bytes(8, "end");
  graph = replaced(graph, bytes(5, raw_int64("end", INT64_MAX)), bytes(5, packed));
  EXPECT_THAT(onnx_input_shape(onnx_without_focus(model(graph))), ElementsAre(1, 12, 32, 16));
}

TEST(OnnxWithoutFocus, AFreeBatchIsOfOneImage) {
  const std::string any = bytes(11, value_info("image", {~std::uint64_t{0}, 3, 64, 32}));
  const std::string graph = replaced(focus() + rest + ends, image, any);
  EXPECT_THAT(onnx_input_shape(onnx_without_focus(model(graph))), ElementsAre(1, 12, 32, 16));
}

TEST(OnnxWithoutFocus, LeavesAloneWhatDoesAnythingElseWithTheImage) {
  const std::string graph = focus() + rest + ends;
  ASSERT_THAT(onnx_without_focus(model(graph)), Not(IsEmpty()));
  const std::string in_order = concat({"upper_left", "lower_left", "upper_right", "lower_right"});
  const std::pair<std::string, std::string> changes[] = {
      {rest, rest + node("Identity", {"image"}, "also")},
      {rest, rest + node("Identity", {"upper"}, "also")},
      {bytes(12, value_info("y", {1, 12, 32, 16})),
       bytes(12, value_info("upper_left", {1, 3, 32, 16}))},
      // Other orders, another axis, a part twice.
      {in_order, concat({"lower_left", "upper_left", "upper_right", "lower_right"})},
      {in_order, concat({"upper_left", "lower_left", "lower_left", "lower_right"})},
      {in_order, concat({"upper_left", "lower_left", "upper_right"})},
      {in_order, concat({"upper_left", "lower_left", "upper_right", "lower_right"}, 2)},
      {node("Slice", {"upper", "zero", "end", "three", "two"}, "upper_left"),
       node("Slice", {"upper", "zero", "end", "two", "two"}, "upper_left")},
      // Other steps, starts and ends, numbers that are not to be had.
      {bytes(5, int64_tensor("three", {3})), bytes(5, int64_tensor("three", {1}))},
      {bytes(5, int64_tensor("three", {3})), bytes(5, int64_tensor("three", {3, 3}))},
      {bytes(5, raw_int64("one", 1)), bytes(5, raw_int64("one", 2))},
      {bytes(5, raw_int64("one", 1)), bytes(5, raw_int64("one", ~std::uint64_t{0}))},
      {bytes(5, raw_int64("two", 2)), bytes(5, raw_int64("two", 3))},
      {bytes(5, raw_int64("end", INT64_MAX)), bytes(5, raw_int64("end", 63))},
      {bytes(5, raw_int64("zero", 0)), ""},
      {node("Slice", {"image", "zero", "end", "two", "two"}, "upper"),
       node("Slice", {"image", "zero", "end", "two"}, "upper")},
      // Images of other shapes.
      {image, bytes(11, value_info("image", {1, 4, 64, 32}))},
      {image, bytes(11, value_info("image", {1, 3, 63, 32}))},
      {image, bytes(11, value_info("image", {1, 3, 64}))},
      {image, bytes(11, value_info("picture", {1, 3, 64, 32}))},
      {image, image + bytes(11, value_info("other", {1, 3, 64, 32}))},
  };
  for (const auto& [what, by] : changes) {
    EXPECT_THAT(onnx_without_focus(model(replaced(graph, what, by))), IsEmpty())
        << what << " -> " << by;
  }
}

TEST(OnnxWithoutFocus, IsEmptyForOtherFiles) {
  EXPECT_THAT(onnx_without_focus(""), IsEmpty());
  EXPECT_THAT(onnx_without_focus("this is not a network"), IsEmpty());
  EXPECT_THAT(onnx_without_focus(std::string(100, '\xFF')), IsEmpty());
  EXPECT_THAT(onnx_without_focus(model(node("Identity", {"image"}, "y") + ends)), IsEmpty());
  const std::string whole = model(focus() + rest + ends);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NO_THROW(onnx_without_focus(whole.substr(0, size)));
  }
}

}  // namespace
}  // namespace dkp_slam
