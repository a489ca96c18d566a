#include "dkp_slam/config/yaml/option_file.h"

#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

struct Inner {
  float share = 0.25F;
  void describe(OptionList& list) { list.add("share", share, between(0, 1), "", "of the whole"); }
};

struct Part {
  int count = 40;
  Inner inner;
  double seconds = 1.5;
  void describe(OptionList& list) {
    list.add("count", count, at_least(1), "frames", "that count");
    list.add_part("inner", inner, "a part of the part");
    list.add("seconds", seconds, above(0), "seconds", "that pass");
  }
};

enum class Mode { off, paper };

struct Whole {
  std::string file;
  Mode mode = Mode::off;
  Part part;
  bool fast = true;
  void describe(OptionList& list) {
    list.add("file", file, "to read");
    list.add("mode", mode, {{Mode::off, "off"}, {Mode::paper, "paper"}}, "what is done");
    list.add_part("part", part, "that does it");
    list.add("fast", fast, "or slow");
  }
};

class OptionFile : public ::testing::Test {
 protected:
  OptionFile()
      : file_(fs::temp_directory_path() /
              fmt::format("option_file_{}.yaml",
                          ::testing::UnitTest::GetInstance()->current_test_info()->name())) {}
  ~OptionFile() override { fs::remove_all(file_); }

  Whole read(const std::string& text) const {
    std::ofstream(file_) << text;
    Whole whole;
    OptionList list = OptionList::of(whole);
    read_option_file(file_, list);
    return whole;
  }
  /// What it says, without the file's name.
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const Error& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.starts_with(file_.string() + ":")) << what;
      return what.substr(file_.string().size() + 1);
    }
    return "none";
  }

  const fs::path file_;
};

TEST_F(OptionFile, WritesEveryTextSoThatItIsReadBack) {
  for (const std::string text :
       {"", "it's", "say \"a\\b\"", "two\nlines\r\n", "\ttab ", "a\"b\\\x7f\x01", "# none",
        "\xff\xfe no UTF-8", "\xc3\xa4\n\xff"}) {
    Whole whole;
    whole.file = text;
    EXPECT_EQ(read(option_file_text(OptionList::of(whole))).file, text);
  }
}

TEST_F(OptionFile, TextHasUnitMeaningAndBoundsOfEach) {
  Whole whole;
  whole.file = "it's here: #1";
  EXPECT_EQ(option_file_text(OptionList::of(whole)),
            "file: 'it''s here: #1'                # to read\n"
            "mode: off                             # what is done; one of off, paper\n"
            "\n"
            "part:                                 # that does it\n"
            "  count: 40                           # [frames] that count; at least 1\n"
            "  inner:                              # a part of the part\n"
            "    share: 0.25                       # of the whole; from 0 to 1\n"
            "  seconds: 1.5                        # [seconds] that pass; above 0\n"
            "fast: true                            # or slow\n");
}

TEST_F(OptionFile, ItsOwnTextGivesTheSameOptions) {
  Whole whole;
  whole.file = "'quoted' # and\\odd: ";
  whole.mode = Mode::paper;
  whole.part.inner.share = 1.0F / 3.0F;
  whole.part.seconds = 1.0 / 3.0;
  whole.fast = false;
  const std::string text = option_file_text(OptionList::of(whole));
  Whole back = read(text);
  EXPECT_EQ(back.file, whole.file);
  EXPECT_EQ(back.part.inner.share, whole.part.inner.share);
  EXPECT_EQ(back.part.seconds, whole.part.seconds);
  EXPECT_EQ(option_file_text(OptionList::of(back)), text);
}

TEST_F(OptionFile, OptionsThatItDoesNotNameStay) {
  const Whole whole = read("part: {inner: {share: 0.5}}\n");
  EXPECT_EQ(whole.part.inner.share, 0.5F);
  EXPECT_EQ(whole.part.count, 40);
  EXPECT_TRUE(whole.fast);
}

TEST_F(OptionFile, MistakesNameTheLine) {
  EXPECT_EQ(refusal("fast: true\npart:\n  coumt: 3\n"),
            "3: there is no option part.coumt; did you mean part.count?");
  EXPECT_EQ(refusal("part:\n  count: 0\n"),
            "2: part.count is '0'; it must be a whole number at least 1");
  EXPECT_EQ(refusal("\n\nmode: slow\n"), "3: mode is 'slow'; it must be one of off, paper");
  EXPECT_EQ(refusal("part: 3\n"), "1: part is a part; its options belong below it, indented");
  EXPECT_EQ(refusal("part:\n"), "1: part is a part; its options belong below it, indented");
  EXPECT_EQ(refusal("part:\n  count: [1, 2]\n"),
            "2: part.count has no single value; it must be a whole number at least 1");
  EXPECT_EQ(refusal("fast: true\nfast: false\n"), "2: fast is given twice");
  EXPECT_EQ(refusal("[1, 2]: 3\n"), "1: a name must stand here");
  EXPECT_THAT(refusal("part: {count: 3\n"), ::testing::HasSubstr("no YAML: "));
}

TEST_F(OptionFile, NoMapAndNoFile) {
  EXPECT_EQ(refusal(""), "1: empty; give at least one option");
  EXPECT_EQ(refusal("# nothing\n"), "1: empty; give at least one option");
  EXPECT_EQ(refusal("- a\n- b\n"), "1: no map of options, such as 'tracking: {...}'");
  EXPECT_EQ(refusal("words\n"), "1: no map of options, such as 'tracking: {...}'");
  Whole whole;
  OptionList list = OptionList::of(whole);
  EXPECT_THROW(read_option_file(file_.string() + ".none", list), Error);
  EXPECT_THROW(read_option_file(fs::temp_directory_path(), list), Error);
  EXPECT_THAT([&] { read_option_file("/dev/zero", list); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("over a megabyte")));
}

}  // namespace
}  // namespace dkp_slam
