#include "dkp_slam/sensor/layout/pose_text.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map_file/test_folder.h"

namespace dkp_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string problem_of(const std::string& text) {
  try {
    pose_of_matrix(parse_matrix(text, "file"), "file");
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

TEST(PoseText, ReadsARotationWithATranslation) {
  // A quarter turn about z, as 7-Scenes writes numbers.
  const auto pose = pose_of_matrix(
      parse_matrix("0 -1.0000000e+000 0 1.5\r\n1 0\t0 -2\n0 0 1 3e-001\n 0 0 0 1 \n", "file"),
      "file");
  ASSERT_TRUE(pose);
  EXPECT_TRUE(((*pose) * Eigen::Vector3d(1.0, 0.0, 0.0)).isApprox(Eigen::Vector3d(1.5, -1.0, 0.3)));
}

TEST(PoseText, WhatIsNotFiniteIsUnknown) {
  const std::string row = "-inf -inf -inf -inf\n";
  EXPECT_FALSE(pose_of_matrix(parse_matrix(row + row + row + row, "file"), "file"));
  EXPECT_FALSE(pose_of_matrix(parse_matrix("1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1", "file"), "file"));
}

TEST(PoseText, AnythingElseIsOneLine) {
  EXPECT_THAT(problem_of(""), HasSubstr("file: has 0 numbers"));
  EXPECT_THAT(problem_of("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0"), HasSubstr("has 15 numbers"));
  EXPECT_THAT(problem_of("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1"), HasSubstr("more than the 16"));
  EXPECT_THAT(problem_of("1 0 0 0 0 1 0 0 0 0 1 0 0 0 zero 1"), HasSubstr("\"zero\" is no number"));
  EXPECT_THAT(problem_of("2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"), HasSubstr("no rotation"));
  EXPECT_THAT(problem_of("-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"), HasSubstr("no rotation"));
  EXPECT_THAT(problem_of("1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1"), HasSubstr("last row"));
}

TEST(PoseText, IntrinsicsArePinholeAlone) {
  const auto of = [](const std::string& text) {
    return intrinsics_of_matrix(parse_matrix(text, "file"), "file");
  };
  const Intrinsics found = of("577.9 0 319.5 0\n0 578.7 239.5 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_EQ(found.fx, 577.9);
  EXPECT_EQ(found.fy, 578.7);
  EXPECT_EQ(found.cx, 319.5);
  EXPECT_EQ(found.cy, 239.5);
  for (const char* wrong :
       {"577.9 1 319.5 0 0 578.7 239.5 0 0 0 1 0 0 0 0 1",
        "0 0 319.5 0 0 1 239.5 0 0 0 1 0 0 0 0 1", "nan 0 319.5 0 0 1 239.5 0 0 0 1 0 0 0 0 1",
        "9 0 3 0 0 -9 3 0 0 0 1 0 0 0 0 1"}) {
    EXPECT_THAT([&] { of(wrong); }, ThrowsMessage<Error>(HasSubstr("file: are no intrinsics")));
  }
}

using PoseFile = testing::FolderTest;

TEST_F(PoseFile, IsNamedWhereItIsMissingOrHuge) {
  EXPECT_THAT([this] { read_matrix(folder_ / "none.txt"); },
              ThrowsMessage<Error>(HasSubstr("none.txt: cannot be read")));
  std::ofstream(folder_ / "huge.txt") << std::string(100'000, ' ');
  EXPECT_THROW(read_matrix(folder_ / "huge.txt"), Error);
}

}  // namespace
}  // namespace dkp_slam
