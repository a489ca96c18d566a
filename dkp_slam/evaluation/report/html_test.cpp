#include "dkp_slam/evaluation/report/html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/canvas.h"
#include "dkp_slam/evaluation/report/test_markup.h"
#include "tests/support/image_files.h"

namespace dkp_slam {
namespace {

using dkp_slam::testing::MarkupCheck;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Markup, TheCheckFindsWhatIsWrong) {
  const auto problem = [](const std::string& text) { return MarkupCheck(text).problem(); };
  EXPECT_EQ(problem("<p class=\"a\">x &amp; y<br/></p>"), "");
  EXPECT_EQ(problem("<p><script>a < b && c</script></p>"), "");
  EXPECT_THAT(problem("<script>\"</script>\"</script>"), HasSubstr("closes what is not open"));
  EXPECT_THAT(problem("<p>x"), HasSubstr("never closed: p"));
  EXPECT_THAT(problem("<b><i></b></i>"), HasSubstr("closes what is not open"));
  EXPECT_THAT(problem("<p>a & b</p>"), HasSubstr("stray &"));
  EXPECT_THAT(problem("<p class=a></p>"), HasSubstr("without quotes"));
  EXPECT_THAT(problem("<p>a < b</p>"), HasSubstr("tag without a name"));
}

TEST(Html, TextIsEscapedBetweenTagsAndInAttributes) {
  EXPECT_EQ(escaped("a<b & \"c\" > 'd'\x01\n"), "a&lt;b &amp; &quot;c&quot; &gt; &#39;d&#39;?\n");
  EXPECT_EQ(escaped("dürr – 5 µm"), "dürr – 5 µm");
}

TEST(Html, NamesCannotBreakThePage) {
  const std::string evil = "</td><script>alert('1')</script>\"&\x02";
  HtmlTable table({evil, "n"});
  table.add({HtmlCell(evil, evil), evil}, HtmlRow::ours);
  const std::string page =
      html_page(evil, html_heading(evil, evil) + html_paragraph(evil) + table.text() +
                          html_figure({html_image(evil, evil)}, evil));
  EXPECT_EQ(MarkupCheck(page).problem(), "");
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_EQ(dkp_slam::testing::occurrences(page, "<script>"), 1U);  // the page's own
  EXPECT_EQ(dkp_slam::testing::occurrences(page, "&lt;script&gt;"), 11U);
}

TEST(Html, ThePageNeedsNothingElse) {
  const std::string page = html_page("t", "<p>x</p>");
  for (const char* other : {"http://", "https://", "src=", "<link", "url(", "@import"}) {
    EXPECT_THAT(page, Not(HasSubstr(other)));
  }
  EXPECT_THAT(page, HasSubstr("default-src &#39;none&#39;"));
  EXPECT_THAT(page, HasSubstr("Copyright (c) 2022 Leon Sorokin"));  // uPlot's licence
}

TEST(Html, MissingCellsAreEmptyAndUnnamedHeadersAreLeftOut) {
  HtmlTable table({"a", "b"});
  EXPECT_TRUE(table.empty());
  table.add({"1"});
  EXPECT_FALSE(table.empty());
  EXPECT_THAT(table.text(), HasSubstr("<td class=\"l\">1</td><td></td>"));
  HtmlTable unnamed({"", ""});
  unnamed.add({"1", "2"});
  EXPECT_THAT(unnamed.text(), Not(HasSubstr("<th")));
}

TEST(Html, PicturesAreWithinThePage) {
  cv::Mat picture(20, 30, CV_8UC3, cv::Scalar(200, 30, 10));
  const std::string address = data_uri(picture);
  const std::string start = "data:image/jpeg;base64,";
  ASSERT_TRUE(address.starts_with(start));
  // Decoded by hand, as a browser does.
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<uchar> bytes;
  const std::string text = address.substr(start.size());
  ASSERT_EQ(text.size() % 4, 0U);
  for (std::size_t i = 0; i < text.size(); i += 4) {
    unsigned bits = 0, missing = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t digit = digits.find(text[i + k]);
      missing += text[i + k] == '=' ? 1 : 0;
      bits = bits << 6 | (digit == std::string::npos ? 0U : static_cast<unsigned>(digit));
    }
    for (unsigned k = 0; k + missing < 3; ++k) bytes.push_back(bits >> (16 - 8 * k) & 255U);
  }
  const cv::Mat back = testing::image_of(bytes);
  ASSERT_EQ(back.size(), picture.size());
  EXPECT_LT(cv::norm(back, picture, cv::NORM_INF), 12.0);
  EXPECT_THROW(data_uri(cv::Mat()), Error);
}

TEST(Canvas, RectanglesAndPicturesLandWhereTheyShould) {
  const cv::Mat red(10, 10, CV_8UC3, cv::Scalar(0, 0, 255));
  auto canvas = png_canvas(40, 20);
  canvas->rectangle({0.0, 0.0}, {10.0, 20.0}, {0, 0, 255});
  canvas->image({20.0, 5.0}, {30.0, 10.0}, red);  // beyond the page to the right
  const std::string png = canvas->encode();
  const cv::Mat page = testing::image_of(std::vector<uchar>(png.begin(), png.end()));
  ASSERT_EQ(page.size(), cv::Size(80, 40));
  EXPECT_EQ(page.at<cv::Vec3b>(20, 10), cv::Vec3b(255, 0, 0));
  EXPECT_EQ(page.at<cv::Vec3b>(20, 60), cv::Vec3b(0, 0, 255));
  EXPECT_EQ(page.at<cv::Vec3b>(20, 30), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(page.at<cv::Vec3b>(5, 60), cv::Vec3b(255, 255, 255));
  auto svg = svg_canvas(40, 20);
  svg->rectangle({0.0, 0.0}, {10.0, 20.0}, {0, 0, 255});
  svg->image({20.0, 5.0}, {10.0, 10.0}, red);
  const std::string text = svg->encode();
  MarkupCheck check(text);
  EXPECT_EQ(check.problem(), "");
  EXPECT_EQ(check.count("rect"), 2U);  // the page's white and ours
  EXPECT_EQ(check.count("image"), 1U);
}

}  // namespace
}  // namespace dkp_slam
