// Measures how long a frame waits for the closing of a loop in a large map: for its part in finding
// the loop, in moving the map, in fusing landmarks and in adjusting the whole. The map is that of a
// sequence up to shortly before its loop, repeated until it has the wanted size; the sequence's
// rest is played there and back in it, at its own speed and as in real time.

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/benches.h"
#include "bench/thread_time.h"
#include "dkp_slam/error.h"
#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/map/map_parts.h"
#include "dkp_slam/map/map_snapshot.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "dkp_slam/stopwatch.h"
#include "dkp_slam/system/back_end.h"
#include "dkp_slam/tracking/tracker.h"

namespace dkp_slam::bench {
namespace loop {
namespace {

struct BenchOptions {
  std::string sequence, camera;
  int keyframes = 2000;
  int before = 120;        // frames from where the large map is entered to where the loop is found
  int most_frames = 9000;  // to wait for the adjustment of the whole map
  double rate = 30.0;      // frames a second, of the clock; their time stamps are the sequence's
  bool at_once = false, verbose = false;
};

struct Span {
  double wall_ms, processor_ms;
};

template <class Work>
Span time_of(Work&& work) {
  const Stopwatch watch;
  const ThreadTime time;
  work();
  return {watch.ms(), time.ms()};
}

/// Always the same work, about 1.3 ms of it: what the machine makes of that is what it adds to the
/// longest waits.
void control() {
  static std::vector<std::uint32_t> memory(1 << 18, 1);
  std::uint32_t at = 1;
  for (int i = 0; i < 1'000'000; ++i) {
    at = at * 1664525 + 1013904223;
    memory[at >> 14] += at;
  }
}

/// A frame's wait for the back end before it is tracked.
struct Wait {
  Span advance, control;
  std::size_t loops;  // put right by then
  int adjustments;    // of the whole map, carried back by then
};

/// Tracking thread and what works beside it.
class Player {
 public:
  Player(Map start, const BackEndOptions& options, bool realtime)
      : map(std::move(start)),
        back_end(map, places, MeasurementModel(), options, realtime),
        tracker_(map, places, MeasurementModel(), TrackerOptions()) {
    for (int k = 0; k < map.keyframe_ids(); ++k) {
      if (!map.keyframe(k).removed) places.add_keyframe(map, k);
    }
  }

  Wait play(const FrameFeatures& features, double timestamp) {
    Frame frame;
    frame.index = index_++;
    frame.timestamp = timestamp;
    frame.features = features;
    frame.is_static.assign(static_cast<std::size_t>(features.size()), 1);
    const Wait wait{time_of([&] { back_end.advance(frame.index); }), time_of(control),
                    back_end.loops().size(), back_end.whole_adjustments()};
    const TrackingResult tracked = tracker_.track(frame, back_end.adjusting());
    if (tracked.keyframe_due) back_end.insert_keyframe(frame);
    if (tracked.localised) tracker_.settle(frame, tracked.keyframe_due);
    lost += !tracked.localised;
    return wait;
  }

  Map map;
  PlaceIndex places;
  BackEnd back_end;
  int lost = 0;

 private:
  Tracker tracker_;
  int index_ = 0;
};

std::vector<FrameFeatures> features_of(const std::string& sequence, const Camera& camera) {
  std::vector<FrameFeatures> all;
  const auto source = open_tum_folder(sequence, camera);
  const OrbExtractor orb;
  cv::Mat grey;
  while (const auto frame = source->read()) {
    cv::cvtColor(frame->colour, grey, cv::COLOR_BGR2GRAY);
    all.emplace_back(orb.extract(grey), frame->depth, camera);
  }
  return all;
}

/// The map side by side with itself, as one: each copy hangs on the one before, and looks like no
/// other. The last one is the map itself, where it was.
MapParts repeated(const MapParts& map, int keyframes) {
  const int copies = std::max(1, keyframes / static_cast<int>(map.keyframes.size()));
  std::mt19937_64 random(7);
  std::optional<MapParts> all;
  for (int c = copies - 1; c >= 0; --c) {
    MapParts copy = map;
    const Se3 moved(Eigen::Quaterniond::Identity(), {30.0 * c, 0.0, 0.0});
    Descriptor other{};
    if (c > 0) other = {random(), random(), random(), random()};
    for (Keyframe& k : copy.keyframes) {
      k.camera_from_world = k.camera_from_world * moved.inverse();
      for (Descriptor& d : k.features.descriptor) {
        for (std::size_t i = 0; i < d.size(); ++i) d[i] ^= other[i];
      }
    }
    for (Landmark& l : copy.landmarks) l.position = moved * l.position;
    const int last = all ? all->keyframes.back().id : -1;
    all = all ? merged(std::move(*all), std::move(copy)) : std::move(copy);
    for (Keyframe& k : all->keyframes) {
      if (k.map != 0 && k.parent < 0) k.parent = last;
      k.map = 0;
    }
    all->maps = 1;
    all->current_map = 0;
  }
  return std::move(*all);
}

BackEndOptions back_end_options(const BenchOptions& bench) {
  BackEndOptions options;
  if (!bench.at_once) return options;
  options.loops.detector.features_per_frame = std::numeric_limits<std::size_t>::max();
  options.loops.gathered_per_frame = std::numeric_limits<int>::max() / 2;
  options.loops.effort_per_frame = std::numeric_limits<int>::max();
  options.loops.delay = 0;
  options.loops.keyframes_per_frame_of_delay = std::numeric_limits<int>::max();
  options.mapper.full.sightings_per_frame = std::numeric_limits<std::size_t>::max();
  options.mapper.full.outliers_per_frame = std::numeric_limits<std::size_t>::max();
  options.followed_per_frame = std::numeric_limits<std::size_t>::max();
  return options;
}

void print(const char* what, const std::vector<Wait>& waits, Span Wait::*part = &Wait::advance) {
  if (waits.empty()) return;
  const auto sorted = [&](double Span::*member) {
    std::vector<double> values;
    for (const Wait& w : waits) values.push_back(w.*part.*member);
    std::sort(values.begin(), values.end());
    return values;
  };
  const std::vector<double> cpu = sorted(&Span::processor_ms), wall = sorted(&Span::wall_ms);
  fmt::print("{:44} {:5} frames, ms: median {:.2f}, 99% {:.2f}, longest {:.2f} (clock: {:.2f})\n",
             what, waits.size(), cpu[cpu.size() / 2], cpu[cpu.size() * 99 / 100], cpu.back(),
             wall.back());
}

void measure(const BenchOptions& bench) {
  spdlog::set_level(bench.verbose ? spdlog::level::debug : spdlog::level::warn);
  const Camera camera = load_camera(bench.camera);
  const std::vector<FrameFeatures> frames = features_of(bench.sequence, camera);
  const OrbOptions orb;
  const auto empty_map = [&] { return Map(camera, orb.scale, orb.levels); };
  const auto time_of = [&](std::size_t frame) { return double(frame) / 30.0; };

  std::size_t found = 0;  // frame with the loop
  {
    Player whole(empty_map(), BackEndOptions(), false);
    for (std::size_t i = 0; i < frames.size() && whole.back_end.loops().empty(); ++i)
      whole.play(frames[i], time_of(i));
    if (whole.back_end.loops().empty()) throw Error(bench.sequence + ": has no loop");
    const int keyframe = whole.back_end.loops().front().keyframe;
    found = static_cast<std::size_t>(whole.map.keyframe(keyframe).frame_index);
  }
  const std::size_t enter = found - std::min(found, static_cast<std::size_t>(bench.before));
  BackEndOptions no_loops;
  no_loops.close_loops = false;
  Player first(empty_map(), no_loops, false);
  for (std::size_t i = 0; i < enter; ++i) first.play(frames[i], time_of(i));
  first.back_end.finish(false);

  Player large(Map(repeated(parts_of(first.map), bench.keyframes)), back_end_options(bench),
               !bench.at_once);
  fmt::print("{} keyframes, {} landmarks\n", large.map.live_keyframes(),
             large.map.live_landmarks());
  std::vector<Wait> waits;
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  int after = 90;  // frames after all is done, in which outliers go
  for (std::size_t i = 0; i < static_cast<std::size_t>(bench.most_frames) && after > 0; ++i) {
    std::this_thread::sleep_until(
        start + std::chrono::duration_cast<Clock::duration>(
                    std::chrono::duration<double>(bench.at_once ? 0.0 : double(i) / bench.rate)));
    const std::size_t rest = frames.size() - enter, phase = i % (2 * rest);
    waits.push_back(
        large.play(frames[enter + (phase < rest ? phase : 2 * rest - 1 - phase)], time_of(i)));
    const Wait& wait = waits.back();
    if (wait.advance.processor_ms > 2.5) {
      spdlog::info("frame {} waited {:.2f} ms: loops {}, adjustments {}", i,
                   wait.advance.processor_ms, wait.loops, wait.adjustments);
    }
    after -= wait.adjustments > 0;
  }
  std::vector<Wait> before, moved, later;
  for (const Wait& w : waits)
    (w.loops == 0 ? before : w.adjustments == 0 ? moved : later).push_back(w);
  print("until the loop is closed", before);
  print("then, until the whole map is adjusted", moved);
  print("from then on", later);
  print("all", waits);
  print("control: the same work each frame", waits, &Wait::control);
  fmt::print("{} loops, {} frames lost\n", large.back_end.loops().size(), large.lost);
}

}  // namespace
}  // namespace loop

void add_loop(CLI::App& program) {
  CLI::App* app = program.add_subcommand(
      "loop", "How long a frame waits for the closing of a loop, ms of processor time");
  const auto bench = std::make_shared<loop::BenchOptions>();
  app->add_option("sequence", bench->sequence, "TUM folder with a loop")->required();
  app->add_option("--camera", bench->camera, "camera file")->required();
  app->add_option("--keyframes", bench->keyframes, "of the map, about")->capture_default_str();
  app->add_option("--before", bench->before, "frames that are played until the loop is found")
      ->capture_default_str();
  app->add_option("--frames", bench->most_frames, "that are played at most")->capture_default_str();
  app->add_option("--rate", bench->rate, "frames a second")->capture_default_str();
  app->add_flag("--at-once", bench->at_once, "each step in one frame, which waits for it");
  app->add_flag("--verbose", bench->verbose, "with the log");
  app->callback([bench] { loop::measure(*bench); });
}

}  // namespace dkp_slam::bench
