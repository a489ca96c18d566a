#pragma once

#include <memory>
#include <string>

#include "viewer/playback_gate.h"
#include "viewer/routes.h"
#include "viewer/scene.h"

namespace dkp_slam::viewer {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< an IP address; others than this machine's need a token
  int port = 0;                       ///< 0: any that is free
};

/// Serves the page and the scene's data over HTTP, in threads of its own. What it costs it costs
/// only while pages are open.
class Server {
 public:
  static constexpr int most_pages = Routes::most_pages;
  /// Connections that are worked on at a time; more wait.
  static constexpr int most_threads = 72;

  /// Listens at once. `gate`: of the playback, which pages may pause; null where nothing can be
  /// paused. Throws `Error` where the address or the port cannot be had.
  Server(std::shared_ptr<Scene> scene, std::shared_ptr<PlaybackGate> gate,
         const ServerOptions& options);
  /// Ends all connections.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// What to open, with the token where one is needed.
  std::string url() const;
  int port() const;
  /// Open now: streams, of which pages of one browser share one.
  int pages() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dkp_slam::viewer
