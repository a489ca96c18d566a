#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/demo/demo.h"
#include "apps/test_command.h"
#include "dkp_slam/evaluation/report/test_markup.h"
#include "tests/support/image_files.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::charts_of;
using dkp_slam::testing::content;
using dkp_slam::testing::MarkupCheck;
using ::testing::HasSubstr;

class DemoCommand : public testing::CommandTest {
 protected:
  int demo(const std::vector<std::string>& more) { return call({"demo", "--out", out()}, more); }
  fs::path out() const { return folder_ / "out"; }
};

TEST_F(DemoCommand, WritesAPageAndAPictureWithoutAModel) {
  ASSERT_EQ(demo({"--frames", "16", "--seed", "3"}), 0) << stderr_;
  const cv::Mat picture = testing::read_image(out() / "demo.png");
  ASSERT_EQ(picture.size(), cv::Size(apps::demo_picture_width, apps::demo_picture_height));
  // Not blank anywhere: head, charts and frames all have contrast.
  for (const cv::Rect part : {cv::Rect(0, 0, 1600, 90), cv::Rect(0, 230, 800, 400),
                              cv::Rect(800, 230, 800, 400), cv::Rect(0, 700, 1600, 360)}) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(picture(part), mean, deviation);
    EXPECT_GT(deviation[0], 8.0) << part;
  }
  const std::string page = content(out() / "report.html");
  MarkupCheck check(page);
  EXPECT_EQ(check.problem(), "");
  const auto charts = charts_of(page);
  ASSERT_EQ(charts.size(), 2U);
  ASSERT_EQ(charts[0].at("series").size(), 3U);
  EXPECT_GE(charts[0].at("series")[0].at("x").size(), 16U);  // the truth is denser
  for (const int run : {1, 2}) EXPECT_EQ(charts[0].at("series")[run].at("x").size(), 16U);
  EXPECT_EQ(check.count("img"), 8U);  // four frames as both modes saw them
  EXPECT_THAT(page, HasSubstr("the motion detector, which needs no model"));
  EXPECT_THAT(page, HasSubstr("seed 3, 16 frames"));
  EXPECT_THAT(stdout_, HasSubstr("detector: the motion detector"));
  EXPECT_THAT(stdout_, HasSubstr((out() / "demo.png").string()));
  EXPECT_THAT(stderr_, HasSubstr("3/3 people left out: 16 of 16"));
}

TEST_F(DemoCommand, BadInputIsRefusedInOneLine) {
  EXPECT_EQ(demo({"--frames", "3"}), 2);
  EXPECT_EQ(demo({"--model", folder_ / "nothing.onnx"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("nothing.onnx"));
  EXPECT_FALSE(fs::exists(out()));
  fs::create_directories(out() / "sequence");
  std::ofstream(out() / "sequence" / "mine.txt") << "precious";
  EXPECT_EQ(demo({"--frames", "10"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("was not made by synth"));
  EXPECT_EQ(content(out() / "sequence" / "mine.txt"), "precious");
  fs::remove_all(out());
  std::ofstream(out()) << "a file";
  EXPECT_EQ(demo({"--frames", "10"}), 1);
  EXPECT_THAT(stderr_, HasSubstr("cannot make the output folder"));
}

}  // namespace
}  // namespace dkp_slam
