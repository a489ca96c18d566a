#include "dkp_slam/sensor/layout/numbered_images.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map_file/test_folder.h"

namespace dkp_slam {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::ThrowsMessage;

class NumberedImages : public testing::FolderTest {
 protected:
  void touch(const std::string& name) const { std::ofstream(folder_ / name) << "x"; }
};

TEST_F(NumberedImages, AreInTheOrderOfTheirValues) {
  for (const char* name : {"10.png", "9.png", "000100.png", "1.jpg", "x2.png", "3.txt", ".png",
                           "-4.png", "5a.png", "1234567890123.png"}) {
    touch(name);
  }
  EXPECT_THAT(
      numbered_files(folder_, "", {".png", ".jpg"}),
      ElementsAre(Pair(1, "1.jpg"), Pair(9, "9.png"), Pair(10, "10.png"), Pair(100, "000100.png")));
  touch("frame-000007.color.png");
  EXPECT_THAT(numbered_files(folder_, "frame-", {".color.png"}),
              ElementsAre(Pair(7, "frame-000007.color.png")));
  EXPECT_TRUE(numbered_files(folder_ / "none", "", {".png"}).empty());
}

TEST_F(NumberedImages, OneNumberTwiceIsRefused) {
  touch("7.png");
  touch("007.png");
  EXPECT_THAT([this] { numbered_files(folder_, "", {".png"}); },
              ThrowsMessage<Error>(HasSubstr("007.png and 7.png have one number")));
}

TEST_F(NumberedImages, GapsAreGapsInTimeAndWhatHasNoPartnerIsLeftOut) {
  const NumberedFiles colour{{0, "0.png"}, {1, "1.png"}, {2, "2.png"}, {30, "30.png"}};
  const NumberedFiles depth{{0, "0.png"}, {2, "2.png"}, {3, "3.png"}, {30, "030.png"}};
  const auto pairs = pair_by_number(folder_, "rgb", colour, "depth", depth, 15.0);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[1].colour, "rgb/2.png");
  EXPECT_EQ(pairs[1].timestamp, 2.0 / 15.0);
  EXPECT_EQ(pairs[2].depth, "depth/030.png");
  EXPECT_EQ(pairs[2].timestamp, 2.0);
  EXPECT_EQ(pairs[2].depth_timestamp, 2.0);
  const NumberedFiles other{{5, "5.png"}};
  EXPECT_THAT(
      [&] { pair_by_number(folder_, "rgb", colour, "depth", other, 30.0); },
      ThrowsMessage<Error>(HasSubstr("none of 4 colour images has the number of one of 1")));
}

}  // namespace
}  // namespace dkp_slam
