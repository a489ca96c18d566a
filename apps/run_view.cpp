#include "apps/run_view.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include "apps/process.h"
#include "apps/progress.h"
#include "dkp_slam/error.h"
#include "viewer/scene_observer.h"

namespace dkp_slam::apps {
namespace {

/// Takes messages to the page.
class SceneSink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit SceneSink(std::shared_ptr<viewer::Scene> scene) : scene_(std::move(scene)) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const char* level = message.level >= spdlog::level::err    ? "error"
                        : message.level >= spdlog::level::warn ? "warning"
                                                               : "info";
    scene_->add_message(level,
                        printable(std::string(message.payload.data(), message.payload.size())));
  }
  void flush_() override {}

 private:
  const std::shared_ptr<viewer::Scene> scene_;
};

}  // namespace

std::vector<CLI::Option*> add_server_options(CLI::App& command, ViewOptions& options) {
  return {
      command.add_option("--port", options.server.port, "Port of the page; 0: any that is free")
          ->check(CLI::Range(0, 65535))
          ->capture_default_str(),
      command
          .add_option("--listen", options.server.address,
                      "IP address to serve the page on; another than this machine's own "
                      "127.0.0.1 needs the token in the address that is printed")
          ->capture_default_str()};
}

LiveView::LiveView(const ViewOptions& options, viewer::SceneInfo info, bool pausable)
    : scene_(std::make_shared<viewer::Scene>(std::move(info))),
      gate_(pausable ? std::make_shared<viewer::PlaybackGate>(options.paused) : nullptr),
      server_(scene_, gate_, options.server),
      messages_(std::make_shared<SceneSink>(scene_)) {
  if (options.paused && !pausable) throw Error("--paused: not in real time, where nothing waits");
  spdlog::default_logger()->sinks().push_back(messages_);
  std::fputs(fmt::format("view: {}\n", server_.url()).c_str(), stderr);
  std::fflush(stderr);
}

LiveView::~LiveView() { std::erase(spdlog::default_logger()->sinks(), messages_); }

void LiveView::join(Slam& slam) const {
  ObserverOptions options;
  options.map = true;
  options.map_interval = 1.0;  // looking for what changed is the only cost to the tracker
  slam.add_observer(std::make_shared<viewer::SceneObserver>(scene_), options);
}

std::unique_ptr<RgbdSource> LiveView::gated(std::unique_ptr<RgbdSource> source) const {
  return std::make_unique<viewer::GatedSource>(std::move(source), gate_, &interrupt_flag());
}

void LiveView::stay() const {
  constexpr auto look = std::chrono::milliseconds(50);
  while (!interrupted()) std::this_thread::sleep_for(look);
}

}  // namespace dkp_slam::apps
