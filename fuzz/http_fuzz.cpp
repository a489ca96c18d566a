// Requests to the live view: their lines, headers, parameters and commands, and what is answered.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "dkp_slam/system/observer.h"
#include "fuzz/target.h"
#include "viewer/routes.h"

// After Eigen: it defines a macro, _res, that is a name there.
#include <httplib.h>

namespace dkp_slam::fuzz {
namespace {

using viewer::PlaybackGate;
using viewer::Routes;
using viewer::Scene;

/// A connection whose other end has said everything, and is gone when an event stream begins.
class Conversation : public httplib::Stream {
 public:
  explicit Conversation(std::string said) : said_(std::move(said)) {}

  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }
  ssize_t read(char* to, std::size_t size) override {
    const std::size_t count = std::min(size, said_.size() - read_);
    said_.copy(to, count, read_);
    read_ += count;
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* from, std::size_t size) override {
    if (answer_.find("Content-Type: text/event-stream") != std::string::npos) return -1;
    answer_.append(from, size);
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = "127.0.0.1";
    port = 40'000;
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    ip = "127.0.0.1";
    port = 8080;
  }
  socket_t socket() const override { return 0; }

  const std::string& answer() const { return answer_; }

 private:
  const std::string said_;
  std::size_t read_ = 0;
  std::string answer_;
};

/// As it would be had it read this from a socket.
class Server : public httplib::Server {
 public:
  std::string answer_to(const std::string& said) {
    Conversation conversation(said);
    bool closed = false;
    process_request(conversation, true, closed, nullptr);
    return conversation.answer();
  }
};

std::shared_ptr<Scene> scene_with_a_map() {
  viewer::SceneInfo info;
  info.truth = {{0.0, {}}, {1.0, {}}};
  auto scene = std::make_shared<Scene>(info);
  KeyframeSnapshot keyframe;
  keyframe.id = 1;
  scene->add_keyframe(keyframe);
  scene->add_message("info", "begun");
  return scene;
}

/// The view, on this machine alone or to be shown a token.
class View {
 public:
  explicit View(const std::string& token) : routes_(scene_with_a_map(), gate_) {
    viewer::AccessRules rules;
    rules.token = token;
    rules.cookie = "dkp_slam_8080";
    routes_.set_rules(rules);
    routes_.add_to(http_);
  }

  void check(const std::string& said, const std::string& token) {
    gate_->pause(false);
    const std::string answer = http_.answer_to(said);
    require(routes_.pages() == 0, "a page that went counts as there");
    const bool paused = gate_->paused();
    require(!paused || said.starts_with("POST"), "paused by no command");
    if (answer.empty()) return;  // no request
    require(answer.starts_with("HTTP/1.1 "), "no answer of HTTP");
    constexpr std::size_t most_answer = 4'000'000;  // the page's largest file, and more
    require(answer.size() < most_answer, "a request that is answered with megabytes");
    require(!answer.starts_with("HTTP/1.1 500"), "a request that ends in an exception");
    const bool shown = token.empty() || said.find('%') != std::string::npos ||
                       said.find(token) != std::string::npos;
    const bool given = answer.find("Content-Type: application/") != std::string::npos;
    require(shown || !(given || paused), "data without the token");
  }

 private:
  const std::shared_ptr<PlaybackGate> gate_ = std::make_shared<PlaybackGate>();
  Routes routes_;
  Server http_;
};

const std::string secret = "0123456789abcdef";

void run(Bytes bytes) {
  static View open(""), closed(secret);
  Reader input(bytes);
  const bool with_token = input.below(2) == 1;
  (with_token ? closed : open).check(text_of(input.rest()), with_token ? secret : "");
}

std::string get(const std::string& path, const std::string& headers = "") {
  return "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1:8080\r\n" + headers + "\r\n";
}

std::string post(const std::string& body, const std::string& headers) {
  return "POST /api/playback HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nOrigin: http://127.0.0.1:8080\r\n"
         "Content-Type: application/json\r\n" +
         headers + "\r\n" + body;
}

std::vector<std::string> seeds() {
  const std::string alone(1, '\0'), token(1, '\1');
  return {
      alone + get("/"),
      alone + get("/api/stream"),
      alone + get("/api/update?run=0&frame=-1&path=0&map=18446744073709551615&message=1"),
      alone + get("/api/picture?frame=2147483647"),
      alone + get("/page.js", "Range: bytes=0-,0-,-9,3-4\r\n"),
      alone + get("/api/cloud?keyframe=%31", "Accept-Encoding: gzip\r\n"),
      alone + get("/api/error", "Origin: http://a.b\r\nSec-Fetch-Site: cross-site\r\n"),
      alone + post(R"({"do": "pause"})", "Content-Length: 15\r\n"),
      alone + post("f\r\n{\"do\": \"pause\"}\r\n0\r\n\r\n", "Transfer-Encoding: chunked\r\n"),
      alone + post("--x\r\nContent-Disposition: form-data; name=\"do\"\r\n\r\nstep\r\n--x--\r\n",
                   "Content-Type: multipart/form-data; boundary=x\r\nContent-Length: 65\r\n"),
      token + get("/?token=" + secret),
      token + get("/api/update", "Cookie: a=b; dkp_slam_8080=" + secret + "\r\n"),
      token + get("/api/update?token=" + secret.substr(1)),
  };
}

const Registration registration({"http", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
