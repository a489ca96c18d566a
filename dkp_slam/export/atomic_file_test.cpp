#include "dkp_slam/export/atomic_file.h"

#include <csignal>
#include <iterator>
#include <new>
#include <ostream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dkp_slam/error.h"
#include "tests/support/file_text.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class AtomicFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              (std::string("atomic_file_") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

template <typename Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(AtomicFile, ReplacesTheOldContentAndLeavesNoTemporaryFile) {
  const fs::path path = folder_ / "a.txt";
  write_file_atomically(path, "a longer first content");
  write_file_atomically(path, "second");
  EXPECT_EQ(testing::content(path), "second");
  EXPECT_EQ(files(), 1U);
}

TEST_F(AtomicFile, WhateverKeepsItFromBeingWrittenLeavesNoTemporaryFile) {
  const fs::path path = folder_ / "a.txt";
  write_file_atomically(path, "first");
  EXPECT_THROW(write_file_atomically(path, [](std::ostream&) { throw std::bad_alloc(); }),
               std::bad_alloc);
  EXPECT_EQ(testing::content(path), "first");
  EXPECT_EQ(files(), 1U);
}

TEST_F(AtomicFile, AKillWhileItIsWrittenLeavesNothing) {
  const fs::path path = folder_ / "a.txt";
  for (const char* before : {"", "first"}) {
    if (*before != '\0') write_file_atomically(path, before);
    const pid_t writer = ::fork();
    ASSERT_GE(writer, 0);
    if (writer == 0) {
      write_file_atomically(path, [](std::ostream& stream) {
        stream << std::string(1 << 20, 'x') << std::flush;
        ::raise(SIGKILL);
      });
      ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(writer, &status, 0), writer);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(files(), *before == '\0' ? 0U : 1U);
    if (*before != '\0') {
      EXPECT_EQ(testing::content(path), before);
    }
  }
}

TEST_F(AtomicFile, AGrowingFileShowsOnceItIsSaved) {
  const fs::path path = folder_ / "log.txt";
  GrowingFile file(path);
  std::string all;
  for (int i = 0; i < 20000; ++i) {  // more than any buffer holds
    const std::string line = "line " + std::to_string(i) + "\n";
    file.append(line);
    all += line;
    if (i != 9999) continue;
    EXPECT_EQ(files(), 0U);
    file.save();
    EXPECT_EQ(testing::content(path), all);
    int lines = 0;
    file.for_each_line(
        [&](std::string_view seen) { EXPECT_EQ(seen, "line " + std::to_string(lines++)); });
    EXPECT_EQ(lines, 10000);
  }
  file.save();
  EXPECT_EQ(testing::content(path), all);
  EXPECT_EQ(files(), 1U);
  GrowingFile(path).save();
  EXPECT_EQ(testing::content(path), "");
}

TEST_F(AtomicFile, AGrowingFileThatIsNotSavedLeavesNothing) {
  write_file_atomically(folder_ / "log.txt", "an earlier one");
  { GrowingFile(folder_ / "log.txt").append("lost"); }
  EXPECT_EQ(testing::content(folder_ / "log.txt"), "an earlier one");
  EXPECT_EQ(files(), 1U);
  EXPECT_THAT(message_of([&] { GrowingFile(folder_ / "none/log.txt"); }),
              HasSubstr("none/log.txt"));
}

TEST_F(AtomicFile, KeepsASymbolicLinkAndReplacesItsTarget) {
  write_file_atomically(folder_ / "target", "old");
  fs::create_symlink("target", folder_ / "link");
  write_file_atomically(folder_ / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(testing::content(folder_ / "target"), "new");
}

TEST_F(AtomicFile, WritesIntoADeviceWithoutReplacingIt) {
  check_writable("/dev/null");
  write_file_atomically("/dev/null", "gone");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(AtomicFile, NamesThePlaceAndTheReasonWhenItCannotWrite) {
  const fs::path lost = folder_ / "no" / "a.txt";
  EXPECT_THAT(message_of([&] { check_writable(lost); }),
              ::testing::AllOf(HasSubstr(lost.string()), HasSubstr("does not exist")));
  EXPECT_THAT(message_of([&] { write_file_atomically(lost, "x"); }), HasSubstr("does not exist"));
  EXPECT_THAT(message_of([&] { check_writable(folder_); }), HasSubstr("is a folder"));
}

TEST_F(AtomicFile, ChecksWithoutLeavingOrTouchingAnything) {
  const fs::path path = folder_ / "a.txt";
  check_writable(path);
  EXPECT_EQ(files(), 0U);
  write_file_atomically(path, "kept");
  check_writable(path);
  EXPECT_EQ(testing::content(path), "kept");
}

}  // namespace
}  // namespace dkp_slam
