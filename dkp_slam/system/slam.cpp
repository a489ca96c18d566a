#include "dkp_slam/system/slam.h"

#include <cmath>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "dkp_slam/stopwatch.h"
#include "dkp_slam/system/engine.h"
#include "dkp_slam/system/frame_pipeline.h"
#include "dkp_slam/system/observer_inbox.h"
#include "dkp_slam/system/scaled_config.h"

namespace dkp_slam {
namespace {

constexpr std::size_t kept_results = 18000;  // ten minutes at 30 Hz, 5 MB

std::string size_text(const cv::Mat& image) {
  return fmt::format("{} x {}", image.cols, image.rows);
}

std::string problem_of_mask(const RgbdFrame& frame, const SlamConfig& config) {
  if (frame.mask.empty()) return "";
  if (config.dynamics.mode != DynamicsMode::masks) {
    return fmt::format("it has a mask, which mode {} does not use; set mode masks",
                       mode_info(config.dynamics.mode).name);
  }
  if (frame.mask.type() != CV_8UC1) return "its mask is not of one channel of 8 bits";
  if (frame.mask.size() != frame.colour.size()) {
    return fmt::format("its mask is {} pixels, its colour image {}", size_text(frame.mask),
                       size_text(frame.colour));
  }
  return "";
}

/// What is wrong with a frame; empty when nothing is.
std::string problem_of(const RgbdFrame& frame, const SlamConfig& config,
                       const std::optional<double>& last_timestamp) {
  const Camera& camera = config.camera;
  const cv::Mat& colour = frame.colour;
  const cv::Mat& depth = frame.depth;
  if (colour.type() != CV_8UC3) return "its colour image is not of 3 channels of 8 bits (BGR)";
  if (depth.type() != CV_32FC1) return "its depth image is not of 32-bit floats (metres)";
  if (colour.cols != camera.width || colour.rows != camera.height) {
    return fmt::format("its colour image is {} pixels, the camera {} x {}", size_text(colour),
                       camera.width, camera.height);
  }
  if (depth.size() != colour.size()) {
    return fmt::format(
        "its depth image is {} pixels, its colour image {}; register depth to colour",
        size_text(depth), size_text(colour));
  }
  const cv::Mat& stamped = frame.stamped_depth;
  if (!stamped.empty() && (stamped.type() != depth.type() || stamped.size() != depth.size())) {
    return "its depth image by the time stamps differs from the other in type or size";
  }
  if (std::string problem = problem_of_mask(frame, config); !problem.empty()) return problem;
  if (!std::isfinite(frame.timestamp)) return "its time stamp is no number";
  if (last_timestamp && frame.timestamp <= *last_timestamp) {
    return fmt::format("its time stamp {:.6f} is not after the last frame's {:.6f}",
                       frame.timestamp, *last_timestamp);
  }
  return "";
}

/// Pixels that belong to somebody else may be gone when a thread comes to them.
void own_pixels(cv::Mat& image) {
  if (!image.empty() && !image.u) image = image.clone();
}

}  // namespace

struct Slam::State {
  State(const SlamConfig& c, std::unique_ptr<Detector> detector, std::optional<Map> stored)
      : config(c),
        has_stored_map(stored.has_value()),
        engine(c, std::move(stored)),
        pipeline(std::move(detector), c.orb, c.realtime, c.detector.yolox.looks.nearer) {}

  void track();
  void publish(const std::shared_ptr<FrameSnapshot>& snapshot);
  void publish_state(const FrameResult& result);
  void start();
  std::optional<FrameResult> take(std::unique_lock<std::mutex>& lock);
  const Engine& finished_engine() const;

  const SlamConfig config;
  const bool has_stored_map;
  Engine engine;  // the tracking thread's, until it has ended
  FramePipeline pipeline;
  std::vector<std::unique_ptr<ObserverInbox>> inboxes;

  // Of the thread that feeds.
  std::optional<double> last_timestamp;
  int last_index = -1;
  bool finished = false;

  // Of the tracking thread.
  Stopwatch frame_watch;
  std::size_t published_loops = 0;
  std::optional<double> lost_since;

  mutable std::mutex mutex;  // guards what follows
  std::condition_variable changed;
  std::deque<FrameResult> results;
  int fed = 0, answered = 0, forgotten = 0;
  std::exception_ptr failure;

  std::thread thread;  // started with the first frame
};

void Slam::State::start() {
  if (thread.joinable()) return;
  thread = std::thread([this] {
    name_thread("tracking");
    track();
  });
}

void Slam::State::track() {
  try {
    while (std::optional<PreparedFrame> prepared = pipeline.next()) {
      const auto fed_at = prepared->fed;
      const TraceSpan span("frame", prepared->frame.index);
      const std::shared_ptr<FrameSnapshot> snapshot = engine.track(std::move(*prepared));
      FrameResult& result = snapshot->result;
      result.frame_ms = frame_watch.lap_ms();
      result.latency_ms =
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - fed_at)
              .count();
      {
        const std::lock_guard lock(mutex);
        ++answered;
        results.push_back(result);
        if (results.size() > kept_results) {
          results.pop_front();
          if (forgotten++ == 0) spdlog::warn("results are not polled; the oldest are forgotten");
        }
      }
      changed.notify_all();
      publish(snapshot);
    }
  } catch (...) {
    {
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
    }
    changed.notify_all();
    pipeline.close_input();
  }
}

void Slam::State::publish(const std::shared_ptr<FrameSnapshot>& snapshot) {
  if (inboxes.empty()) return;
  const FrameResult& result = snapshot->result;
  for (const auto& inbox : inboxes) inbox->put_frame(snapshot);
  if (result.keyframe) {
    const Map& map = engine.map();
    const Keyframe& k = map.keyframe(map.keyframe_ids() - 1);
    KeyframeSnapshot keyframe{
        k.id, k.map, k.frame_index, k.timestamp, k.camera_from_world.inverse(), 0};
    for (const int l : k.landmarks) keyframe.landmarks += l >= 0;
    for (const auto& inbox : inboxes) {
      inbox->put([keyframe](SlamObserver& o) { o.on_keyframe(keyframe); });
    }
  }
  const std::vector<ClosedLoop>& loops = engine.loops();
  for (; published_loops < loops.size(); ++published_loops) {
    const ClosedLoop loop = loops[published_loops];
    for (const auto& inbox : inboxes) {
      inbox->put(
          [loop](SlamObserver& o) { loop.joined_maps ? o.on_maps_merged(loop) : o.on_loop(loop); });
    }
  }
  publish_state(result);
  for (const auto& inbox : inboxes) inbox->put_map(engine.map(), result.timestamp, false);
}

void Slam::State::publish_state(const FrameResult& result) {
  TrackingChange change{result.index, result.timestamp, 0.0};
  if (lost_since) change.lost_for = result.timestamp - *lost_since;
  if (result.localised && lost_since) {
    lost_since.reset();
    for (const auto& inbox : inboxes) inbox->put([change](SlamObserver& o) { o.on_found(change); });
  } else if (result.state == TrackingState::lost && !result.localised && !lost_since) {
    lost_since = result.timestamp;
    for (const auto& inbox : inboxes) inbox->put([change](SlamObserver& o) { o.on_lost(change); });
  }
}

std::optional<FrameResult> Slam::State::take(std::unique_lock<std::mutex>& lock) {
  if (results.empty()) {
    if (!failure) return std::nullopt;
    const std::exception_ptr reason = failure;
    lock.unlock();
    std::rethrow_exception(reason);
  }
  FrameResult result = std::move(results.front());
  results.pop_front();
  return result;
}

const Engine& Slam::State::finished_engine() const {
  if (!finished) throw Error("Slam: the map and the trajectories are there after finish()");
  return engine;
}

Slam::Slam(const SlamConfig& config, std::unique_ptr<Detector> detector, std::optional<Map> stored)
    : state_(std::make_unique<State>(scaled_to_camera(config), std::move(detector),
                                     std::move(stored))) {}

Slam::~Slam() {
  state_->pipeline.stop();
  // Whoever waits for an observer stops waiting.
  for (const auto& inbox : state_->inboxes) inbox->stop();
  if (state_->thread.joinable()) state_->thread.join();
}

void Slam::add_observer(std::shared_ptr<SlamObserver> observer, const ObserverOptions& options) {
  if (state_->thread.joinable()) throw Error("Slam: observers are added before the first frame");
  auto inbox =
      std::make_unique<ObserverInbox>(std::move(observer), options, state_->config.realtime);
  if (state_->has_stored_map) inbox->know(state_->engine.map());
  state_->inboxes.push_back(std::move(inbox));
}

void Slam::feed(RgbdFrame frame) {
  State& s = *state_;
  if (s.finished) throw Error("Slam: no frame can be fed after finish()");
  const std::string problem = problem_of(frame, s.config, s.last_timestamp);
  if (!problem.empty()) throw Error(fmt::format("frame {}: {}", frame.index, problem));
  own_pixels(frame.colour);
  own_pixels(frame.depth);
  own_pixels(frame.stamped_depth);
  own_pixels(frame.mask);
  frame.index = std::max(frame.index, s.last_index + 1);
  s.last_index = frame.index;
  s.last_timestamp = frame.timestamp;
  s.start();
  {
    const std::lock_guard lock(s.mutex);
    if (s.failure) std::rethrow_exception(s.failure);
    ++s.fed;
  }
  s.pipeline.push(std::move(frame));
}

std::optional<FrameResult> Slam::poll() {
  std::unique_lock lock(state_->mutex);
  return state_->take(lock);
}

std::optional<FrameResult> Slam::wait() {
  State& s = *state_;
  std::unique_lock lock(s.mutex);
  if (!s.config.realtime) {
    s.changed.wait(lock, [&] { return !s.results.empty() || s.failure || s.answered == s.fed; });
  }
  return s.take(lock);
}

void Slam::finish(const std::atomic<bool>* stop) {
  State& s = *state_;
  if (s.finished) return;
  s.pipeline.close_input();
  if (s.thread.joinable()) s.thread.join();
  std::exception_ptr failure;
  try {
    s.engine.finish(stop);
  } catch (...) {  // out of memory: the map and the paths are as they were before
    failure = std::current_exception();
  }
  s.finished = true;
  const double last = s.last_timestamp.value_or(0.0);
  for (const auto& inbox : s.inboxes) inbox->put_map(s.engine.map(), last, true);
  for (const auto& inbox : s.inboxes) inbox->finish();
  if (failure) std::rethrow_exception(failure);
}

SlamCounters Slam::counters() const {
  const State& s = *state_;
  SlamCounters counters;
  {
    const std::lock_guard lock(s.mutex);
    counters.fed = s.fed;
    counters.answered = s.answered;
    counters.forgotten_results = s.forgotten;
  }
  counters.dropped = s.pipeline.dropped_frames();
  counters.detector_failures = s.pipeline.detector_failures();
  for (const auto& inbox : s.inboxes) {
    counters.observer_exceptions += inbox->exceptions();
    counters.observer_drops += inbox->dropped();
  }
  return counters;
}

std::vector<Trajectory> Slam::trajectories() const {
  return state_->finished_engine().trajectories();
}

Trajectory Slam::trajectory() const {
  std::vector<Trajectory> paths = trajectories();
  return paths.empty() ? Trajectory() : std::move(paths.front());
}

Trajectory Slam::keyframe_trajectory() const {
  return state_->finished_engine().keyframe_trajectory();
}

const Map& Slam::map() const { return state_->finished_engine().map(); }

const std::vector<ClosedLoop>& Slam::loops() const { return state_->finished_engine().loops(); }

}  // namespace dkp_slam
