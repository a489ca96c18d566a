#pragma once

#include <atomic>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "viewer/access.h"
#include "viewer/playback_gate.h"
#include "viewer/scene.h"

namespace httplib {
class Server;
struct Request;
struct Response;
}  // namespace httplib

namespace dkp_slam::viewer {

/// What is answered to whom, whatever the requests come by. Any thread may ask.
class Routes {
 public:
  /// Pages at a time; one more is told so.
  static constexpr int most_pages = 24;

  /// `gate`: of the playback, which pages may pause; null where nothing can be paused.
  Routes(std::shared_ptr<Scene> scene, std::shared_ptr<PlaybackGate> gate);
  Routes(const Routes&) = delete;
  Routes& operator=(const Routes&) = delete;

  /// Into a server that does not listen yet, and that these outlive.
  void add_to(httplib::Server& http);
  /// To be set before anybody asks.
  void set_rules(AccessRules rules) { rules_ = std::move(rules); }
  const AccessRules& rules() const { return rules_; }
  /// Open now: streams, of which pages of one browser share one.
  int pages() const { return pages_; }
  /// Lets all streams end.
  void stop();

 private:
  bool admit(const httplib::Request& request, httplib::Response& response) const;
  void update(const httplib::Request& request, httplib::Response& response) const;
  void picture(const httplib::Request& request, httplib::Response& response) const;
  void command(const httplib::Request& request, httplib::Response& response) const;
  void stream(httplib::Response& response);
  nlohmann::json playback() const;

  const std::shared_ptr<Scene> scene_;
  const std::shared_ptr<PlaybackGate> gate_;
  AccessRules rules_;
  std::atomic<int> pages_{0};
  std::atomic<bool> stopping_{false};
};

}  // namespace dkp_slam::viewer
