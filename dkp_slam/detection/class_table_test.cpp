#include "dkp_slam/detection/class_table.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::filesystem::path write_file(const std::string& text) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) /
      (std::string("dkp_slam_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
       ".yaml");
  std::ofstream(file) << text;
  return file;
}

TEST(ClassTable, KnowsCocoByNumberAndName) {
  EXPECT_EQ(ClassTable::name(0), "person");
  EXPECT_EQ(ClassTable::name(56), "chair");
  EXPECT_EQ(ClassTable::name(79), "toothbrush");
  EXPECT_EQ(ClassTable::name(80), "unknown");
  EXPECT_EQ(ClassTable::name(Detection::motion_class), "moving");
  EXPECT_EQ(ClassTable::find("laptop"), 63);
  EXPECT_FALSE(ClassTable::find("ghost"));
}

TEST(ClassTable, LivingThingsWeighMostAndFurnitureOne) {
  const ClassTable table;
  for (const char* name : {"person", "cat", "dog", "horse"}) {
    EXPECT_EQ(table.weight(*ClassTable::find(name)), 10.0F) << name;
  }
  for (const char* name : {"tv", "couch", "dining table", "keyboard", "potted plant"}) {
    EXPECT_EQ(table.weight(*ClassTable::find(name)), 1.0F) << name;
  }
  for (const char* name : {"chair", "backpack", "handbag", "suitcase", "bottle", "cup", "book",
                           "laptop", "cell phone", "teddy bear", "sports ball"}) {
    EXPECT_GT(table.weight(*ClassTable::find(name)), 1.0F) << name;
    EXPECT_LT(table.weight(*ClassTable::find(name)), 10.0F) << name;
  }
  EXPECT_EQ(table.weight(Detection::motion_class), 10.0F);
}

TEST(ClassTable, ShippedFileEqualsBuiltInWeights) {
  const ClassTable shipped = ClassTable::load(DKP_SLAM_SOURCE_DIR "/config/classes.yaml");
  const ClassTable built_in;
  for (int id = 0; id < ClassTable::class_count; ++id) {
    EXPECT_EQ(shipped.weight(id), built_in.weight(id)) << ClassTable::name(id);
  }
}

TEST(ClassTable, FileChangesWhatItNamesAndNothingElse) {
  const ClassTable table = ClassTable::load(write_file("weights:\n  tv: 2.5\n  person: 7\n"));
  EXPECT_EQ(table.weight(*ClassTable::find("tv")), 2.5F);
  EXPECT_EQ(table.weight(*ClassTable::find("person")), 7.0F);
  EXPECT_EQ(table.weight(*ClassTable::find("chair")), ClassTable().weight(56));
}

TEST(ClassTable, BadFilesAreRefusedWithTheirLine) {
  const auto load = [](const std::string& text) {
    return [text] { ClassTable::load(write_file(text)); };
  };
  EXPECT_THAT(load("weights:\n  tv: 1\n  ghost: 5\n"),
              ThrowsMessage<Error>(HasSubstr("yaml:3: 'ghost'")));
  EXPECT_THAT(load("weights:\n  tv: 11\n"), ThrowsMessage<Error>(HasSubstr("yaml:2: the weight")));
  EXPECT_THAT(load("weights:\n  tv: .nan\n"),
              ThrowsMessage<Error>(HasSubstr("yaml:2: the weight")));
  EXPECT_THAT(load("weights:\n  tv: heavy\n"),
              ThrowsMessage<Error>(HasSubstr("yaml:2: the weight")));
  EXPECT_THAT(load("tv: 3\n"), ThrowsMessage<Error>(HasSubstr("no map 'weights'")));
  EXPECT_THAT(load("weights: [1, 2\n"), ThrowsMessage<Error>(HasSubstr("not YAML")));
  EXPECT_THAT([] { ClassTable::load("no/such/file.yaml"); },
              ThrowsMessage<Error>(HasSubstr("cannot read the class weights")));
  EXPECT_THAT([] { ClassTable::load(::testing::TempDir()); },
              ThrowsMessage<Error>(HasSubstr("it is a folder")));
  EXPECT_THAT([] { ClassTable::load("/dev/zero"); },
              ThrowsMessage<Error>(HasSubstr("a pipe or a device")));
}

}  // namespace
}  // namespace dkp_slam
