#include "dkp_slam/sensor/tum_lists.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

std::string write_list(const std::string& text) {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  const std::string path = ::testing::TempDir() + info->name() + ".txt";
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

template <typename Reader>
std::string error_of(Reader read, const std::string& text) {
  try {
    read(write_list(text));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(TumLists, ReadsStampsAndPathsInEveryCommonDialect) {
  const auto files =
      read_stamped_files(write_list("# timestamp filename\r\n"
                                    "1305031102.175304 rgb/a.png\r\n"
                                    "\r\n"
                                    "1305031103.5\trgb/b.png\n"
                                    "  1305031104,rgb/c.png  # good light\n"
                                    "1305031105.25 rgb/d.png"));
  ASSERT_EQ(files.size(), 4U);
  EXPECT_EQ(files[0].timestamp, 1305031102.175304);
  EXPECT_EQ(files[0].path, "rgb/a.png");
  EXPECT_EQ(files[1].path, "rgb/b.png");
  EXPECT_EQ(files[2].timestamp, 1305031104.0);
  EXPECT_EQ(files[3].path, "rgb/d.png");
}

TEST(TumLists, SortsByTimeAndKeepsTheFirstOfRepeatedStamps) {
  const auto files = read_stamped_files(write_list("3 c\n1 a\n2 first\n2 second\n1 again\n"));
  ASSERT_EQ(files.size(), 3U);
  EXPECT_EQ(files[0].path, "a");
  EXPECT_EQ(files[1].path, "first");
  EXPECT_EQ(files[2].path, "c");
}

TEST(TumLists, NamesTheLineThatIsMalformed) {
  EXPECT_THAT(error_of(read_stamped_files, "1 a\n2\n"), HasSubstr(".txt:2: expected"));
  EXPECT_THAT(error_of(read_stamped_files, "# 1\n\n1 my file.png\n"), HasSubstr(":3: expected"));
  EXPECT_THAT(error_of(read_stamped_files, "one a\n"), HasSubstr(":1: \"one\" is no time stamp"));
  EXPECT_THAT(error_of(read_stamped_files, "1.5x a\n"), HasSubstr("no time stamp"));
  EXPECT_THAT(error_of(read_stamped_files, "nan a\n"), HasSubstr("no time stamp"));
  EXPECT_THAT(error_of(read_associations, "1 rgb/a 1 depth/a\n1 rgb/a 1\n"), HasSubstr(":2: exp"));
  EXPECT_THAT(error_of(read_associations, "1 rgb/a 1 ir/a\n"), HasSubstr(":1: cannot tell"));
  EXPECT_THAT(error_of(read_associations, "1 depth/a 1 depth/b\n"), HasSubstr("cannot tell"));
  EXPECT_THROW(read_stamped_files("/no/such/list.txt"), Error);
}

TEST(TumLists, FindsColourAndDepthColumnsByFolder) {
  const auto colour_first = read_associations(write_list("2 rgb/c.png 2.01 depth/d.png\n"));
  const auto depth_first = read_associations(write_list("2.01 depth/d.png 2 rgb/c.png\n"));
  for (const auto& pairs : {colour_first, depth_first}) {
    ASSERT_EQ(pairs.size(), 1U);
    EXPECT_EQ(pairs[0].timestamp, 2.0);
    EXPECT_EQ(pairs[0].colour, "rgb/c.png");
    EXPECT_EQ(pairs[0].depth, "depth/d.png");
  }
  // The folder's own name counts, not those above it.
  EXPECT_EQ(
      read_associations(write_list("2 in_depth/rgb/c.png 2 in_depth/depth/d.png\n"))[0].colour,
      "in_depth/rgb/c.png");
}

TEST(TumLists, AssociatesNearestFirst) {
  // 1.010 is nearest to 1.011, so 1.000 must take 0.995 although 1.010 is within reach as well.
  EXPECT_THAT(associate({1.000, 1.010}, {0.995, 1.011}, 0.02), ElementsAre(Pair(0, 0), Pair(1, 1)));
  // Greedy, not optimal: the best single pair takes 1.000 - 1.001 and leaves 1.012 alone.
  EXPECT_THAT(associate({1.000, 1.012}, {0.970, 1.001}, 0.02), ElementsAre(Pair(0, 1)));
  // Ties go to the earlier time stamps, as sorting tuples does in associate.py.
  EXPECT_THAT(associate({1.0, 2.0}, {1.5}, 0.6), ElementsAre(Pair(0, 0)));
  EXPECT_THAT(associate({1.5}, {1.0, 2.0}, 0.6), ElementsAre(Pair(0, 0)));
  // The limit itself is too far.
  EXPECT_TRUE(associate({1.0}, {1.5}, 0.5).empty());
  EXPECT_TRUE(associate({}, {1.0}, 0.5).empty());
}

}  // namespace
}  // namespace dkp_slam
