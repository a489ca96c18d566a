// The server on real sockets.
#include "viewer/server.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dkp_slam/error.h"
#include "viewer/test_client.h"

namespace dkp_slam::viewer {
namespace {

using namespace std::chrono_literals;
using dkp_slam::testing::Answer;
using dkp_slam::testing::ask;
using dkp_slam::testing::Connection;
using dkp_slam::testing::head_of;
using dkp_slam::testing::Headers;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::shared_ptr<FrameSnapshot> noisy_frame(int i) {
  auto snapshot = std::make_shared<FrameSnapshot>();
  snapshot->result.index = snapshot->frame.index = i;
  snapshot->result.timestamp = 0.1 * i;
  snapshot->result.localised = true;
  static const cv::Mat noise = [] {
    cv::Mat image(480, 640, CV_8UC3);
    cv::randu(image, 0, 255);
    return image;
  }();
  snapshot->frame.colour = noise;
  snapshot->frame.depth = cv::Mat::ones(480, 640, CV_32F);
  return snapshot;
}

class ServerTest : public ::testing::Test {
 protected:
  const std::shared_ptr<Scene> scene_ = std::make_shared<Scene>(SceneInfo{});
  const std::shared_ptr<PlaybackGate> gate_ = std::make_shared<PlaybackGate>();
  Server server_{scene_, gate_, {}};

  std::string host() const { return "127.0.0.1:" + std::to_string(server_.port()); }
  std::string request_for_stream() const {
    return "GET /api/stream HTTP/1.1\r\nHost: " + host() + "\r\n\r\n";
  }
  Answer command(const std::string& body, Headers headers = {}) const {
    headers.try_emplace("Origin", "http://" + host());
    headers.try_emplace("Content-Type", "application/json");
    return ask(server_.port(), "/api/playback", headers, "POST", body);
  }
  bool pages_become(int wanted) const {
    for (int i = 0; i < 1000 && server_.pages() != wanted; ++i) std::this_thread::sleep_for(10ms);
    return server_.pages() == wanted;
  }
};

TEST_F(ServerTest, ServesThePageAndAllThatItNeeds) {
  EXPECT_THAT(server_.url(), StartsWith("http://127.0.0.1:"));
  const Answer page = ask(server_.port(), "/");
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.body, HasSubstr("<!doctype html>"));
  EXPECT_THAT(page.body, Not(HasSubstr("://")));  // nothing from elsewhere
  for (const char* header :
       {"Content-Security-Policy: default-src 'self'", "X-Content-Type-Options: nosniff",
        "Cross-Origin-Resource-Policy: same-origin", "Referrer-Policy: no-referrer"})
    EXPECT_THAT(page.head, HasSubstr(header));
  for (const char* file : {"/page.js", "/page.css", "/ticks.js", "/icon.svg"})
    EXPECT_EQ(ask(server_.port(), file).status, 200) << file;
  EXPECT_EQ(ask(server_.port(), "/../etc/passwd").status, 404);
  EXPECT_EQ(ask(server_.port(), "/api/picture").status, 204);
  scene_->add_frame(noisy_frame(0));
  EXPECT_EQ(head_of(ask(server_.port(), "/api/picture").body)["frame"], 0);
  EXPECT_EQ(head_of(ask(server_.port(), "/api/update").body)["newest"], 0);
  EXPECT_EQ(ask(server_.port(), "/api/cloud?keyframe=7").status, 404);
  EXPECT_EQ(ask(server_.port(), "/api/error").status, 404);
}

TEST_F(ServerTest, ARequestForThousandsOfPartsTakesNoMemory) {
  std::string ranges = "bytes=0-";
  for (int i = 0; i < 2000; ++i) ranges += ",0-";
  const Answer answer = ask(server_.port(), "/page.js", {{"Range", ranges}});
  EXPECT_EQ(answer.status, 416);
  EXPECT_LT(answer.body.size(), 1U << 20U);  // with all parts it would be gigabytes
  EXPECT_EQ(ask(server_.port(), "/page.js", {{"Range", "bytes=0-9"}}).status, 416);
}

TEST_F(ServerTest, AnswersNobodyElsesPage) {
  const auto status = [&](const char* path, const Headers& headers) {
    return ask(server_.port(), path, headers).status;
  };
  for (const char* path : {"/", "/page.js", "/api/update", "/api/stream", "/api/picture"}) {
    EXPECT_EQ(status(path, {{"Host", "evil.example"}}), 403) << path;
    EXPECT_EQ(status(path, {{"Origin", "http://evil.example"}}), 403) << path;
  }
  EXPECT_EQ(status("/api/update", {{"Sec-Fetch-Site", "cross-site"}}), 403);
  EXPECT_EQ(server_.pages(), 0);
}

TEST_F(ServerTest, CommandsPauseStepAndLetGo) {
  gate_->page_opened();
  EXPECT_EQ(command(R"({"do": "pause"})").status, 200);
  EXPECT_TRUE(gate_->paused());
  EXPECT_EQ(command(R"({"do": "step"})").status, 200);
  EXPECT_EQ(command(R"({"do": "go"})").status, 200);
  EXPECT_FALSE(gate_->paused());
  for (const char* body : {"", "{", "[]", R"({"do": 1})", R"({"do": "format"})"})
    EXPECT_EQ(command(body).status, 400) << body;
  EXPECT_EQ(command(R"({"do": "pause"})", {{"Origin", "http://evil.example"}}).status, 403);
  EXPECT_EQ(command(R"({"do": "pause"})", {{"Content-Type", "text/plain"}}).status, 415);
  EXPECT_EQ(command(std::string(5000, ' ')).status, 413);
  EXPECT_FALSE(gate_->paused());
}

TEST_F(ServerTest, TheStreamSaysWhenThereIsSomethingNew) {
  Connection page(server_.port());
  page.send(request_for_stream());
  EXPECT_THAT(page.read_until("data: "), HasSubstr("text/event-stream"));
  EXPECT_TRUE(pages_become(1));
  page.forget();
  scene_->add_frame(noisy_frame(0));
  EXPECT_THAT(page.read_until("data: "), HasSubstr("data: "));
  page.close();
  EXPECT_TRUE(pages_become(0));
  EXPECT_EQ(gate_->pages(), 0);
}

TEST_F(ServerTest, ManyPagesAtOnceAndOneTooManyIsTold) {
  std::vector<std::unique_ptr<Connection>> pages;
  for (int i = 0; i < Server::most_pages; ++i) {
    pages.push_back(std::make_unique<Connection>(server_.port()));
    pages.back()->send(request_for_stream());
  }
  for (const auto& page : pages) EXPECT_THAT(page->read_until("data: "), HasSubstr("data: "));
  const Answer one_more = ask(server_.port(), "/api/stream");
  EXPECT_EQ(one_more.status, 503);
  EXPECT_THAT(one_more.body, HasSubstr("no more at a time"));
  EXPECT_EQ(ask(server_.port(), "/api/update").status, 200);
  for (const auto& page : pages) page->forget();
  scene_->add_frame(noisy_frame(0));
  for (const auto& page : pages) EXPECT_THAT(page->read_until("data: "), HasSubstr("data: "));
}

TEST_F(ServerTest, APageThatReadsNothingHoldsNobodyUp) {
  // Asks for pictures, 200 kB each, again and again, and never reads one.
  Connection slow(server_.port(), 4096);
  scene_->add_frame(noisy_frame(0));
  for (int i = 0; i < 50; ++i)
    slow.send("GET /api/picture HTTP/1.1\r\nHost: " + host() + "\r\n\r\n");
  Connection stream(server_.port(), 4096);
  stream.send(request_for_stream());
  for (int i = 1; i < 200; ++i) scene_->add_frame(noisy_frame(i));
  EXPECT_EQ(head_of(ask(server_.port(), "/api/update").body)["newest"], 199);
}

TEST_F(ServerTest, APageThatGoesInMidAnswerLeavesNothingBehind) {
  scene_->add_frame(noisy_frame(0));
  for (int i = 0; i < 20; ++i) {
    Connection page(server_.port());
    page.send(i % 2 == 0 ? request_for_stream()
                         : "GET /api/picture HTTP/1.1\r\nHost: " + host() + "\r\n\r\n");
    if (i % 4 < 2) page.read_until("HTTP/1.1");
  }
  EXPECT_TRUE(pages_become(0));
  EXPECT_EQ(ask(server_.port(), "/").status, 200);
}

TEST_F(ServerTest, ANonsensicalRequestIsNoTrouble) {
  for (const std::string& text :
       {std::string("\r\n\r\n"), std::string("GET\r\n\r\n"), std::string(100'000, 'a'),
        "GET /api/update?frame=99999999999999999999&map=-1 HTTP/1.1\r\nHost: " + host() +
            "\r\nConnection: close\r\n\r\n"}) {
    Connection connection(server_.port());
    connection.send(text);
    connection.send("\r\n\r\n");
    connection.read_until("\r\n\r\n");
  }
  EXPECT_EQ(ask(server_.port(), "/").status, 200);
}

TEST_F(ServerTest, APortThatIsTakenIsAnError) {
  EXPECT_THROW(
      {
        try {
          const Server second(scene_, nullptr, {"127.0.0.1", server_.port()});
        } catch (const Error& error) {
          EXPECT_THAT(error.what(), HasSubstr("choose another --port"));
          throw;
        }
      },
      Error);
  EXPECT_THROW(Server(scene_, nullptr, {"localhost", 0}), Error);
}

TEST_F(ServerTest, ElsewhereItNeedsTheToken) {
  const Server open(scene_, nullptr, {"0.0.0.0", 0});
  const std::string url = open.url();
  const std::size_t at = url.find("?token=");
  ASSERT_NE(at, std::string::npos);
  const std::string token = url.substr(at + 7);
  for (const char* path : {"/", "/page.js", "/api/update", "/api/stream",
                           "/?token=", "/?token=00000000000000000000000000000000"})
    EXPECT_EQ(ask(open.port(), path).status, 401) << path;
  const Answer first = ask(open.port(), "/?token=" + token);
  EXPECT_EQ(first.status, 303);
  const std::string cookie = "dkp_slam_" + std::to_string(open.port()) + "=" + token;
  EXPECT_THAT(first.head, HasSubstr("Set-Cookie: " + cookie + "; HttpOnly; SameSite"));
  EXPECT_EQ(ask(open.port(), "/", {{"Cookie", cookie}}).status, 200);
  EXPECT_EQ(ask(open.port(), "/api/update", {{"Cookie", "x=y; " + cookie}}).status, 200);
  EXPECT_EQ(ask(open.port(), "/api/update?token=" + token).status, 200);
  EXPECT_EQ(ask(open.port(), "/", {{"Cookie", cookie}, {"Host", "evil.example"}}).status, 403);
}

TEST_F(ServerTest, EndsWhilePagesAreOpen) {
  auto server = std::make_unique<Server>(scene_, nullptr, ServerOptions{});
  Connection page(server->port());
  page.send("GET /api/stream HTTP/1.1\r\nHost: localhost\r\n\r\n");
  page.read_until("data: ");
  server.reset();
  page.read_all();  // comes to an end
}

}  // namespace
}  // namespace dkp_slam::viewer
