#include "viewer/server.h"

#include <atomic>
#include <charconv>
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <httplib.h>
#include <sys/socket.h>

#include "dkp_slam/error.h"
#include "dkp_slam/json_text.h"
#include "viewer/access.h"
#include "viewer/page_files.h"
#include "viewer/worker_pool.h"

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

class Threads : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> work) override { pool_.enqueue(std::move(work)); }
  void shutdown() override { pool_.shutdown(); }

 private:
  WorkerPool pool_{Server::most_threads};
};

/// A whole number among the parameters; `otherwise` where there is none.
template <class Number>
Number parameter(const Request& request, const char* name, Number otherwise) {
  const std::string text = request.get_param_value(name);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : otherwise;
}

void set_socket(socket_t socket) {
  // Not SO_REUSEPORT, the library's own choice: two programs would share one port unknowingly.
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  // What a page that reads nothing leaves behind is small.
  const int bytes = 64 << 10;
  setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof(bytes));
}

void refuse(Response& response, const Refusal& refusal) {
  response.status = refusal.status;
  response.set_content(refusal.reason + "\n", "text/plain");
}

}  // namespace

struct Server::State {
  State(std::shared_ptr<Scene> its_scene, std::shared_ptr<PlaybackGate> its_gate,
        const ServerOptions& options);
  ~State();

  void add_routes();
  httplib::Server::HandlerResponse admit(const Request& request, Response& response) const;
  void update(const Request& request, Response& response) const;
  void picture(const Request& request, Response& response) const;
  void command(const Request& request, Response& response) const;
  void stream(Response& response);
  nlohmann::json playback() const;

  const std::shared_ptr<Scene> scene;
  const std::shared_ptr<PlaybackGate> gate;
  AccessRules rules;
  int port = 0;
  std::atomic<int> pages{0};
  std::atomic<bool> stopping{false};
  httplib::Server http;
  std::thread thread;
};

Server::State::State(std::shared_ptr<Scene> its_scene, std::shared_ptr<PlaybackGate> its_gate,
                     const ServerOptions& options)
    : scene(std::move(its_scene)), gate(std::move(its_gate)) {
  rules.address = options.address;
  if (!is_address(options.address)) {
    throw Error(fmt::format("--listen {}: is no IP address; 0.0.0.0 stands for all of this machine",
                            options.address));
  }
  if (!is_loopback(options.address)) rules.token = make_token();
  http.new_task_queue = [] { return new Threads; };
  http.set_socket_options(set_socket);
  http.set_tcp_nodelay(true);
  http.set_keep_alive_timeout(3);
  http.set_keep_alive_max_count(100'000);
  http.set_read_timeout(3, 0);
  http.set_write_timeout(3, 0);
  http.set_payload_max_length(most_body);
  http.set_default_headers(safe_headers);
  add_routes();
  port = options.port;
  const bool bound = options.port == 0 ? (port = http.bind_to_any_port(options.address)) > 0
                                       : http.bind_to_port(options.address, options.port);
  if (!bound) {
    throw Error(
        fmt::format("cannot listen on {}:{}: in use, or not this machine's; choose another "
                    "--port or --listen",
                    options.address, options.port));
  }
  rules.cookie = fmt::format("dkp_slam_{}", port);
  thread = std::thread([this] { http.listen_after_bind(); });
  while (!http.is_running()) std::this_thread::sleep_for(1ms);
}

Server::State::~State() {
  stopping = true;
  scene->touch();
  http.stop();
  thread.join();
}

httplib::Server::HandlerResponse Server::State::admit(const Request& request,
                                                      Response& response) const {
  Asker asker;
  asker.method = request.method;
  asker.host = request.get_header_value("Host");
  asker.origin = request.get_header_value("Origin");
  asker.fetch_site = request.get_header_value("Sec-Fetch-Site");
  asker.cookies = request.get_header_value("Cookie");
  asker.token = request.get_param_value("token");
  asker.data = request.path.starts_with("/api/");
  if (const auto refusal = refusal_of(rules, asker)) {
    refuse(response, *refusal);
    return httplib::Server::HandlerResponse::Handled;
  }
  if (!asker.token.empty() && request.path == "/" && !rules.token.empty()) {
    // From here on the cookie shows it, and the address bar does not.
    response.set_header("Set-Cookie", fmt::format("{}={}; HttpOnly; SameSite=Lax; Path=/",
                                                  rules.cookie, rules.token));
    response.set_redirect("/", 303);
    return httplib::Server::HandlerResponse::Handled;
  }
  return httplib::Server::HandlerResponse::Unhandled;
}

void Server::State::add_routes() {
  http.set_pre_routing_handler([this](const Request& q, Response& r) { return admit(q, r); });
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
    const auto cloud = scene->cloud(parameter(q, "keyframe", -1));
    if (!cloud) return refuse(response, {404, "no cloud is kept of this keyframe"});
    response.set_content(*cloud, binary);
  });
  http.Get("/api/error", [this](const Request&, Response& response) {
    const auto report = scene->error();
    if (!report) return refuse(response, {404, "the true path is not known"});
    response.set_content(*report, binary);
  });
  http.Post("/api/playback", [this](const Request& q, Response& r) { command(q, r); });
}

nlohmann::json Server::State::playback() const {
  return {{"pausable", gate != nullptr}, {"paused", gate && gate->paused()}};
}

void Server::State::update(const Request& request, Response& response) const {
  PageState page;
  page.run = request.get_param_value("run");
  page.frame = parameter(request, "frame", -1);
  page.path = parameter(request, "path", 0);
  page.map = parameter<std::uint64_t>(request, "map", 0);
  page.message = parameter(request, "message", 0);
  response.set_content(scene->update(page, playback()), binary);
}

void Server::State::picture(const Request& request, Response& response) const {
  std::optional<int> frame;
  if (request.has_param("frame")) frame = parameter(request, "frame", -1);
  const PictureStore::Picture picture = scene->picture(frame);
  if (!picture) {
    response.status = 204;
    return;
  }
  response.set_content(*picture, binary);
}

void Server::State::command(const Request& request, Response& response) const {
  if (!request.get_header_value("Content-Type").starts_with("application/json"))
    return refuse(response, {415, "a command is JSON"});
  if (!gate) return refuse(response, {409, "what is shown here cannot be paused"});
  const auto json = nlohmann::json::parse(request.body, nullptr, false);
  const std::string wanted =
      json.is_object() && json.contains("do") && json["do"].is_string() ? json["do"] : "";
  if (wanted == "pause" || wanted == "go") {
    gate->pause(wanted == "pause");
  } else if (wanted == "step") {
    gate->step();
  } else {
    return refuse(response, {400, R"(a command is {"do": "pause"}, "go" or "step")"});
  }
  scene->touch();
  response.set_content(json_text(playback(), -1), "application/json");
}

void Server::State::stream(Response& response) {
  if (++pages > most_pages) {
    --pages;
    response.set_header("Retry-After", "5");
    return refuse(response, {503, fmt::format("{} pages are open, no more at a time", most_pages)});
  }
  if (gate) gate->page_opened();
  response.set_header("X-Accel-Buffering", "no");
  auto tick = std::make_shared<std::uint64_t>(0);
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, tick](std::size_t, httplib::DataSink& sink) {
        if (*tick != 0) std::this_thread::sleep_for(least_interval);
        const std::uint64_t now = scene->wait(*tick, heartbeat);
        if (stopping) {
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
        if (gate) gate->page_closed();
        --pages;
      });
}

Server::Server(std::shared_ptr<Scene> scene, std::shared_ptr<PlaybackGate> gate,
               const ServerOptions& options)
    : state_(std::make_unique<State>(std::move(scene), std::move(gate), options)) {}

Server::~Server() = default;

std::string Server::url() const {
  const std::string token = state_->rules.token.empty() ? "" : "?token=" + state_->rules.token;
  return fmt::format("http://{}:{}/{}", in_url(state_->rules.address), state_->port, token);
}

int Server::port() const { return state_->port; }

int Server::pages() const { return state_->pages; }

}  // namespace dkp_slam::viewer
