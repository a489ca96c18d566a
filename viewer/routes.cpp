#include "viewer/routes.h"

#include <charconv>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <httplib.h>

#include "dkp_slam/json_text.h"
#include "viewer/page_files.h"

namespace dkp_slam::viewer {
namespace {

using namespace std::chrono_literals;
using httplib::Request;
using httplib::Response;

constexpr auto least_interval = 50ms;    // from tick to tick
constexpr auto heartbeat = 500ms;        // finds out who has gone
constexpr std::size_t most_body = 1024;  // bytes of a command
const char* const binary = "application/octet-stream";

/// No page but ours, and nothing from elsewhere.
const httplib::Headers safe_headers{
    {"Content-Security-Policy",
     "default-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; "
     "form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cache-Control", "no-store"}};

/// A whole number among the parameters; `otherwise` where there is none.
template <class Number>
Number parameter(const Request& request, const char* name, Number otherwise) {
  const std::string text = request.get_param_value(name);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : otherwise;
}

void refuse(Response& response, const Refusal& refusal) {
  response.status = refusal.status;
  response.set_content(refusal.reason + "\n", "text/plain");
}

}  // namespace

Routes::Routes(std::shared_ptr<Scene> scene, std::shared_ptr<PlaybackGate> gate)
    : scene_(std::move(scene)), gate_(std::move(gate)) {}

void Routes::add_to(httplib::Server& http) {
  http.set_payload_max_length(most_body);
  http.set_default_headers(safe_headers);
  http.set_pre_routing_handler([this](const Request& q, Response& r) {
    return admit(q, r) ? httplib::Server::HandlerResponse::Unhandled
                       : httplib::Server::HandlerResponse::Handled;
  });
  http.set_exception_handler([](const Request&, Response& response, const std::exception_ptr&) {
    refuse(response, {500, "failed; the program's messages may say why"});
  });
  for (const PageFile& file : page_files()) {
    http.Get(file.path, [&file](const Request&, Response& response) {
      response.set_content(file.content.data(), file.content.size(), file.type);
    });
  }
  http.Get("/api/stream", [this](const Request&, Response& r) { stream(r); });
  http.Get("/api/update", [this](const Request& q, Response& r) { update(q, r); });
  http.Get("/api/picture", [this](const Request& q, Response& r) { picture(q, r); });
  http.Get("/api/cloud", [this](const Request& q, Response& response) {
    const auto cloud = scene_->cloud(parameter(q, "keyframe", -1));
    if (!cloud) return refuse(response, {404, "no cloud is kept of this keyframe"});
    response.set_content(*cloud, binary);
  });
  http.Get("/api/fused", [this](const Request& q, Response& response) {
    const auto cloud = scene_->fused_cloud(parameter(q, "map", 0));
    if (cloud) {
      response.set_content(*cloud, binary);
    } else {
      response.status = 204;
    }
  });
  http.Get("/api/error", [this](const Request&, Response& response) {
    const auto report = scene_->error();
    if (!report) return refuse(response, {404, "the true path is not known"});
    response.set_content(*report, binary);
  });
  http.Post("/api/playback", [this](const Request& q, Response& r) { command(q, r); });
}

void Routes::stop() {
  stopping_ = true;
  scene_->touch();
}

/// Whether the request goes on to its route; otherwise it has been answered.
bool Routes::admit(const Request& request, Response& response) const {
  if (!request.ranges.empty()) {
    // The library answers thousands of them at once, each with the whole file, in memory.
    refuse(response, {416, "parts are not served; ask without the header Range"});
    return false;
  }
  Asker asker;
  asker.method = request.method;
  asker.host = request.get_header_value("Host");
  asker.origin = request.get_header_value("Origin");
  asker.fetch_site = request.get_header_value("Sec-Fetch-Site");
  asker.cookies = request.get_header_value("Cookie");
  asker.token = request.get_param_value("token");
  asker.data = request.path.starts_with("/api/");
  if (const auto refusal = refusal_of(rules_, asker)) {
    refuse(response, *refusal);
    return false;
  }
  if (!asker.token.empty() && request.path == "/" && !rules_.token.empty()) {
    // From here on the cookie shows it, and the address bar does not.
    response.set_header("Set-Cookie", fmt::format("{}={}; HttpOnly; SameSite=Lax; Path=/",
                                                  rules_.cookie, rules_.token));
    response.set_redirect("/", 303);
    return false;
  }
  return true;
}

nlohmann::json Routes::playback() const {
  return {{"pausable", gate_ != nullptr}, {"paused", gate_ && gate_->paused()}};
}

void Routes::update(const Request& request, Response& response) const {
  PageState page;
  page.run = request.get_param_value("run");
  page.frame = parameter(request, "frame", -1);
  page.path = parameter<std::uint64_t>(request, "path", 0);
  page.map = parameter<std::uint64_t>(request, "map", 0);
  page.message = parameter(request, "message", 0);
  response.set_content(scene_->update(page, playback()), binary);
}

void Routes::picture(const Request& request, Response& response) const {
  std::optional<int> frame;
  if (request.has_param("frame")) frame = parameter(request, "frame", -1);
  const PictureStore::Picture picture = scene_->picture(frame);
  if (!picture) {
    response.status = 204;
    return;
  }
  response.set_content(*picture, binary);
}

void Routes::command(const Request& request, Response& response) const {
  if (!request.get_header_value("Content-Type").starts_with("application/json"))
    return refuse(response, {415, "a command is JSON"});
  if (!gate_) return refuse(response, {409, "what is shown here cannot be paused"});
  const auto json = nlohmann::json::parse(request.body, nullptr, false);
  const std::string wanted =
      json.is_object() && json.contains("do") && json["do"].is_string() ? json["do"] : "";
  if (wanted == "pause" || wanted == "go") {
    gate_->pause(wanted == "pause");
  } else if (wanted == "step") {
    gate_->step();
  } else {
    return refuse(response, {400, R"(a command is {"do": "pause"}, "go" or "step")"});
  }
  scene_->touch();
  response.set_content(json_text(playback(), -1), "application/json");
}

void Routes::stream(Response& response) {
  if (++pages_ > most_pages) {
    --pages_;
    response.set_header("Retry-After", "5");
    return refuse(response, {503, fmt::format("{} pages are open, no more at a time", most_pages)});
  }
  if (gate_) gate_->page_opened();
  response.set_header("X-Accel-Buffering", "no");
  auto tick = std::make_shared<std::uint64_t>(0);
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, tick](std::size_t, httplib::DataSink& sink) {
        if (*tick != 0) std::this_thread::sleep_for(least_interval);
        const std::uint64_t now = scene_->wait(*tick, heartbeat);
        if (stopping_) {
          sink.done();
          return true;
        }
        // Only that there is something: a page takes what there is when it is ready for it.
        const std::string event =
            now == *tick ? std::string(": still here\n\n") : fmt::format("data: {}\n\n", now);
        *tick = now;
        return sink.write(event.data(), event.size());
      },
      [this](bool) {
        if (gate_) gate_->page_closed();
        --pages_;
      });
}

}  // namespace dkp_slam::viewer
