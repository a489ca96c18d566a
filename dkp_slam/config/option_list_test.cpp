#include "dkp_slam/config/option_list.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/config/test_options.h"
#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using testing::Brush;
using testing::Colour;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Paint;

/// Lists one of its two fields.
struct Forgetful {
  int known = 1, forgotten = 2;
  void describe(OptionList& list) { list.add("known", known, any_number(), "", "listed"); }
};

struct HoldsForgetful {
  Forgetful part;
  void describe(OptionList& list) { list.add_part("part", part, "that forgets a field"); }
};

/// Names a field of its part as if it were its own.
struct Toolbox {
  struct Hammer {
    int weight = 3, age = 1;
    void describe(OptionList& list) {
      list.add("weight", weight, any_number(), "", "of it");
      list.leave_out();  // the age
    }
  };
  Hammer hammer;
  bool open = false;
  void describe(OptionList& list) {
    list.add("age", hammer.age, any_number(), "years", "of the hammer");
    list.of_a_part();
    list.add_part("hammer", hammer, "to hit with");
    list.add("open", open, "or shut");
  }
};

template <class F>
std::string problem_of(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

std::vector<std::string> names_of(const OptionList& list) {
  std::vector<std::string> names;
  for (const Option& option : list.options()) names.push_back(option.name);
  return names;
}

TEST(FieldCount, CountsAStructInAStructOnce) {
  EXPECT_EQ(field_count<Brush>(), 2U);
  EXPECT_EQ(field_count<Paint>(), 9U);
  EXPECT_EQ(field_count<HoldsForgetful>(), 1U);
}

TEST(OptionList, NamesFieldsWithTheirParts) {
  Paint paint;
  EXPECT_THAT(names_of(OptionList::of(paint)),
              ElementsAre("thickness", "seed", "wet", "name", "colour", "brush.width",
                          "brush.hairs", "least", "most"));
  Toolbox box;
  EXPECT_THAT(names_of(OptionList::of(box)), ElementsAre("age", "hammer.weight", "open"));
}

TEST(OptionList, AForgottenFieldIsAMistakeOfTheProgram) {
  Forgetful forgetful;
  EXPECT_THROW(OptionList::of(forgetful), std::logic_error);
  HoldsForgetful holder;
  EXPECT_THROW(OptionList::of(holder), std::logic_error);
}

TEST(OptionList, ValuesAsText) {
  Paint paint;
  OptionList list = OptionList::of(paint);
  EXPECT_EQ(list.find("thickness")->text(), "0.3");
  EXPECT_EQ(list.find("wet")->text(), "true");
  EXPECT_EQ(list.find("colour")->text(), "green");
  EXPECT_EQ(list.find("brush.hairs")->text(), "100");
  EXPECT_EQ(list.find("hairs"), nullptr);
}

TEST(OptionList, AssignsEachType) {
  Paint paint;
  OptionList list = OptionList::of(paint);
  list.assign("thickness=0.1");
  list.assign("seed=18446744073709551615");
  list.assign("wet=false");
  list.assign("name=a=b c");
  list.assign("colour=red");
  list.assign("brush.width=1e-2");
  EXPECT_EQ(paint.thickness, 0.1F);
  EXPECT_EQ(paint.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_FALSE(paint.wet);
  EXPECT_EQ(paint.name, "a=b c");
  EXPECT_EQ(paint.colour, Colour::red);
  EXPECT_EQ(paint.brush.width, 0.01);
}

TEST(OptionList, RefusesWhatIsNoneAndStaysAsItWas) {
  Paint paint;
  OptionList list = OptionList::of(paint);
  const auto refusal = [&](const std::string& text) {
    return problem_of([&] { list.assign(text); });
  };
  EXPECT_EQ(refusal("brush.hairs=0"),
            "brush.hairs is '0'; it must be a whole number from 1 to 1000");
  EXPECT_EQ(refusal("brush.hairs=7.5"),
            "brush.hairs is '7.5'; it must be a whole number from 1 to 1000");
  EXPECT_EQ(refusal("brush.hairs=99999999999"),
            "brush.hairs is '99999999999'; it must be a whole number from 1 to 1000");
  EXPECT_EQ(refusal("brush.width=0"),
            "brush.width is '0'; it must be a number above 0 and at most 1");
  EXPECT_EQ(refusal("thickness=thin"), "thickness is 'thin'; it must be a number at least 0");
  EXPECT_EQ(refusal("thickness=inf"), "thickness is 'inf'; it must be a number at least 0");
  EXPECT_EQ(refusal("thickness="), "thickness is ''; it must be a number at least 0");
  EXPECT_EQ(refusal("seed=-1"), "seed is '-1'; it must be a whole number");
  EXPECT_EQ(refusal("wet=yes"), "wet is 'yes'; it must be true or false");
  EXPECT_EQ(refusal("colour=blue"), "colour is 'blue'; it must be one of red, green");
  EXPECT_EQ(refusal("wet"), "'wet' is no part.field=value");
  EXPECT_EQ(refusal("brush=1"), "brush is a part and has no value; name one of its fields");
  EXPECT_EQ(paint.brush.hairs, 100);
  EXPECT_EQ(paint.thickness, 0.3F);
}

TEST(OptionList, TellsTheNearestName) {
  Paint paint;
  OptionList list = OptionList::of(paint);
  const auto refusal = [&](const std::string& text) {
    return problem_of([&] { list.assign(text + "=1"); });
  };
  EXPECT_EQ(refusal("brush.hair"), "there is no option brush.hair; did you mean brush.hairs?");
  EXPECT_THAT(refusal("hairs"), HasSubstr("did you mean brush.hairs?"));
  EXPECT_THAT(refusal("bursh.width"), HasSubstr("did you mean brush.width?"));
  EXPECT_THAT(refusal("color"), HasSubstr("did you mean colour?"));
}

TEST(OptionList, ChecksFieldValueAndBound) {
  Paint paint;
  EXPECT_NO_THROW(paint.check());
  paint.brush.hairs = 0;
  EXPECT_EQ(problem_of([&] { paint.check(); }),
            "brush.hairs is 0; it must be a whole number from 1 to 1000");
  EXPECT_EQ(problem_of([&] { paint.brush.check(); }),
            "hairs is 0; it must be a whole number from 1 to 1000");
  paint.brush.hairs = 1000;
  EXPECT_NO_THROW(paint.check());
  paint.brush.width = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(problem_of([&] { paint.check(); }), HasSubstr("brush.width is nan; it must be"));
  paint.brush.width = 1.0;
  paint.colour = static_cast<Colour>(7);
  EXPECT_THAT(problem_of([&] { paint.check(); }), HasSubstr("colour is 7; it must be one of"));
}

TEST(OptionList, ChecksTheOrderOfTwo) {
  Paint paint;
  paint.least = 5;
  EXPECT_NO_THROW(paint.check());
  paint.least = 6;
  EXPECT_EQ(problem_of([&] { paint.check(); }), "least is 6; it must be at most most, which is 5");
}

}  // namespace
}  // namespace dkp_slam
