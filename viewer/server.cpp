#include "viewer/server.h"

#include <chrono>
#include <functional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <httplib.h>
#include <sys/socket.h>

#include "dkp_slam/error.h"
#include "viewer/access.h"
#include "viewer/worker_pool.h"

namespace dkp_slam::viewer {
namespace {

class Threads : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> work) override { pool_.enqueue(std::move(work)); }
  void shutdown() override { pool_.shutdown(); }

 private:
  WorkerPool pool_{Server::most_threads};
};

void set_socket(socket_t socket) {
  // Not SO_REUSEPORT, the library's own choice: two programs would share one port unknowingly.
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  // What a page that reads nothing leaves behind is small.
  const int bytes = 64 << 10;
  setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof(bytes));
}

}  // namespace

struct Server::State {
  State(std::shared_ptr<Scene> scene, std::shared_ptr<PlaybackGate> gate,
        const ServerOptions& options);
  ~State();

  Routes routes;
  int port = 0;
  httplib::Server http;
  std::thread thread;
};

Server::State::State(std::shared_ptr<Scene> scene, std::shared_ptr<PlaybackGate> gate,
                     const ServerOptions& options)
    : routes(std::move(scene), std::move(gate)) {
  AccessRules rules;
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
  routes.add_to(http);
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
  routes.set_rules(rules);
  thread = std::thread([this] { http.listen_after_bind(); });
  while (!http.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

Server::State::~State() {
  routes.stop();
  http.stop();
  thread.join();
}

Server::Server(std::shared_ptr<Scene> scene, std::shared_ptr<PlaybackGate> gate,
               const ServerOptions& options)
    : state_(std::make_unique<State>(std::move(scene), std::move(gate), options)) {}

Server::~Server() = default;

std::string Server::url() const {
  const AccessRules& rules = state_->routes.rules();
  const std::string token = rules.token.empty() ? "" : "?token=" + rules.token;
  return fmt::format("http://{}:{}/{}", in_url(rules.address), state_->port, token);
}

int Server::port() const { return state_->port; }

int Server::pages() const { return state_->routes.pages(); }

}  // namespace dkp_slam::viewer
