// `dkp-slam view` and `run --view`, started as a user does.
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/test_program.h"
#include "apps/test_sequence.h"
#include "dkp_slam/map_file/test_folder.h"
#include "viewer/test_client.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using dkp_slam::testing::ask;
using dkp_slam::testing::Connection;
using dkp_slam::testing::content;
using dkp_slam::testing::frame_count;
using dkp_slam::testing::head_of;
using dkp_slam::testing::Program;
using dkp_slam::testing::WallSequence;
using ::testing::HasSubstr;
using ::testing::Not;

class ViewCommandTest : public testing::FolderTest {
 protected:
  Program start(const std::string& name, std::vector<std::string> arguments) const {
    fs::create_directories(folder_ / name);
    return {folder_ / name, std::move(arguments), {}};
  }
  static int port_of(const Program& program) {
    program.wait_for("view: http://127.0.0.1:");
    const std::string said = program.err();
    const std::string before = "view: http://127.0.0.1:";
    const std::size_t at = said.find(before);
    return at == std::string::npos ? 0 : std::stoi(said.substr(at + before.size()));
  }
  static nlohmann::json wait_for_end(int port) {
    nlohmann::json head;
    for (int i = 0; i < 500; ++i) {
      head = head_of(ask(port, "/api/update").body);
      if (head["finished"] == true) break;
      std::this_thread::sleep_for(20ms);
    }
    return head;
  }
};

TEST_F(ViewCommandTest, PagesChangeNothingInARunAndAMapOpensToo) {
  const WallSequence wall(folder_ / "wall", frame_count);
  const std::string sequence = wall.folder().string();
  const std::string plain = (folder_ / "plain").string(), seen = (folder_ / "seen").string();
  const std::string map = (folder_ / "wall.map").string();
  EXPECT_EQ(start("a", {"run", sequence, "--mode", "off", "--out", plain}).wait(), 0);

  const Program view =
      start("b", {"view", sequence, "--mode", "off", "--out", seen, "--paused", "--map", map});
  const int port = port_of(view);
  ASSERT_GT(port, 0);
  EXPECT_EQ(head_of(ask(port, "/api/update").body)["newest"], -1);
  std::vector<std::unique_ptr<Connection>> pages;
  for (int i = 0; i < 10; ++i) {
    pages.push_back(std::make_unique<Connection>(port));
    pages.back()->send("GET /api/stream HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  const std::string host = "127.0.0.1:" + std::to_string(port);
  ask(port, "/api/playback", {{"Origin", "http://" + host}, {"Content-Type", "application/json"}},
      "POST", R"({"do": "go"})");
  for (int i = 0; i < 20; ++i) ask(port, "/api/picture");
  pages.resize(3);
  const nlohmann::json end = wait_for_end(port);
  EXPECT_EQ(end["newest"], frame_count - 1);
  EXPECT_EQ(end["truth"], true);
  EXPECT_FALSE(end["keyframes"].empty());
  EXPECT_GE(head_of(ask(port, "/api/error").body)["matches"], 2);
  view.interrupt();
  EXPECT_EQ(view.wait(), 0);
  EXPECT_EQ(content(fs::path(plain) / "trajectory.txt"),
            content(fs::path(seen) / "trajectory.txt"));

  const Program stored = start("c", {"view", map});
  const nlohmann::json shown = head_of(ask(port_of(stored), "/api/update").body);
  EXPECT_EQ(shown["kind"], "map");
  EXPECT_FALSE(shown["keyframes"].empty());
  EXPECT_GT(shown["landmarks"], 100);
  stored.interrupt();
  EXPECT_EQ(stored.wait(), 0);
  const Program wrong = start("d", {"view", map, "--mode", "off"});
  EXPECT_EQ(wrong.wait(), 2);
  EXPECT_THAT(wrong.err(), HasSubstr("is for a sequence"));
}

TEST_F(ViewCommandTest, ARunWithAViewEndsWithTheRun) {
  const WallSequence wall(folder_ / "wall", frame_count);
  const Program run = start("a", {"run", wall.folder().string(), "--mode", "off", "--view", "--out",
                                  (folder_ / "out").string()});
  EXPECT_EQ(run.wait(), 0);
  EXPECT_THAT(run.err(), HasSubstr("view: http://127.0.0.1:"));
  const Program once = start("b", {"view", wall.folder().string(), "--mode", "off", "--once"});
  EXPECT_EQ(once.wait(), 0);
}

TEST_F(ViewCommandTest, WrongOptionsAreSaidBeforeAnythingIsWritten) {
  const WallSequence wall(folder_ / "wall", 2);
  const std::string out = (folder_ / "out").string();
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{"run", wall.folder().string(), "--mode", "off", "--out", out};
    all.insert(all.end(), more.begin(), more.end());
    const Program program = start("a", all);
    const int code = program.wait();
    return std::pair(code, program.err());
  };
  EXPECT_EQ(run({"--port", "8000"}).first, 2);  // without --view
  EXPECT_EQ(run({"--view", "--port", "70000"}).first, 2);
  const auto [code, said] = run({"--view", "--listen", "example.org"});
  EXPECT_EQ(code, 1);
  EXPECT_THAT(said, HasSubstr("is no IP address"));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace dkp_slam
