// Measures place recognition and relocalisation in maps of growing size: time, memory, and how many
// frames find their place. The map is that of a real sequence's first half, hidden among generated
// keyframes; the second half's frames look for their place in it.

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/benches.h"
#include "bench/thread_time.h"
#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/localization/relocalizer.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "dkp_slam/system/engine.h"

namespace dkp_slam::bench {
namespace place {
namespace {

struct BenchOptions {
  std::string sequence, camera;
  std::vector<int> keyframes{500, 1000, 2000};
  int features = 1000;       // of a generated keyframe, all of them landmarks
  int new_features = 125;    // of which the keyframe before does not see so many
  int place_keyframes = 50;  // until another place begins
  int queries = 200;
  int tables = PlaceIndexOptions().tables;
};

/// A frame that looks for its place, and where it was by tracking.
struct Query {
  Frame frame;
  Se3 camera_from_world;
};

/// What a real sequence gives.
struct Real {
  Map map;  // of its first half
  std::vector<Query> queries;
  std::vector<Descriptor> looks;
  std::vector<int> bits_wrong;  // of sightings against their landmark
};

Real play(const BenchOptions& bench) {
  SlamConfig options;
  options.camera = load_camera(bench.camera);
  options.dynamics.mode = DynamicsMode::off;
  Engine engine(options);
  const auto source = open_tum_folder(bench.sequence, options.camera);
  const OrbExtractor extractor(options.orb);
  const std::size_t half = source->size().value_or(0) / 2;
  std::size_t i = 0;
  Real real{engine.map(), {}, {}, {}};
  while (auto frame = source->read()) {
    PreparedFrame prepared;
    prepared.frame = std::move(*frame);
    cv::cvtColor(prepared.frame.colour, prepared.grey, cv::COLOR_BGR2GRAY);
    prepared.orb = extractor.extract(prepared.grey);
    const FrameResult result = engine.track(prepared)->result;
    if (++i == half) real.map = engine.map();
    if (i % 2 == 0) {
      real.looks.insert(real.looks.end(), prepared.orb.descriptors.begin(),
                        prepared.orb.descriptors.end());
    }
    if (i < half || !result.localised) continue;
    Query q;
    q.frame.index = prepared.frame.index;
    q.frame.features = FrameFeatures(prepared.orb, prepared.frame.depth, options.camera);
    const auto features = static_cast<std::size_t>(q.frame.features.size());
    q.frame.is_static.assign(features, 1);
    q.frame.landmark.assign(features, -1);
    q.camera_from_world = result.world_from_camera.inverse();
    real.queries.push_back(std::move(q));
  }
  for (const int l : real.map.landmarks()) {
    const Landmark& landmark = real.map.landmark(l);
    for (const Sighting& s : landmark.sightings) {
      const auto& seen = real.map.keyframe(s.keyframe).features.descriptor;
      const int bits =
          hamming_distance(landmark.descriptor, seen[static_cast<std::size_t>(s.feature)]);
      if (bits > 0) real.bits_wrong.push_back(bits);
    }
  }
  return real;
}

/// Keyframes of places that look as real ones do, bit by bit, but are none of them.
class Generator {
 public:
  Generator(const BenchOptions& bench, const Real& real, Map& map)
      : bench_(bench), real_(real), map_(map) {}

  int add_keyframe() {
    if (keyframes_++ % bench_.place_keyframes == 0) window_.clear();
    const int kept = window_.empty() ? 0 : bench_.features - bench_.new_features;
    window_.erase(window_.begin(), window_.end() - kept);
    Keyframe k;
    for (const int l : window_) add_feature(k, turned(true_look_.at(l)), l);
    while (static_cast<int>(k.landmarks.size()) < bench_.features) add_feature(k, look(), -1);
    const int id = map_.add_keyframe(std::move(k));
    for (int f = kept; f < bench_.features; ++f) {
      const int l = map_.add_landmark({0.0, 0.0, 2.0}, id, f);
      true_look_[l] = map_.landmark(l).descriptor;
      window_.push_back(l);
    }
    map_.update_covisibility(id);
    generated_.push_back(id);
    return id;
  }

  /// Half of what one of the keyframes sees, and as much that is seen nowhere.
  std::vector<Descriptor> view(int& keyframe) {
    keyframe = generated_[random_() % generated_.size()];
    std::vector<Descriptor> seen;
    const std::vector<int>& landmarks = map_.keyframe(keyframe).landmarks;
    for (std::size_t f = 0; f < landmarks.size(); ++f) {
      seen.push_back(f % 2 ? turned(true_look_.at(landmarks[f])) : look());
    }
    return seen;
  }

 private:
  static void add_feature(Keyframe& k, const Descriptor& d, int landmark) {
    k.features.descriptor.push_back(d);
    k.features.pixel.emplace_back();
    k.features.depth.push_back(2.0F);
    k.features.level.push_back(0);
    k.features.angle.push_back(0.0F);
    k.landmarks.push_back(landmark);
  }
  /// Bits of two real descriptors by turns: frequent bits stay frequent, but it is neither.
  Descriptor look() {
    const Descriptor& a = real_.looks[random_() % real_.looks.size()];
    const Descriptor& b = real_.looks[random_() % real_.looks.size()];
    Descriptor d;
    for (std::size_t i = 0; i < d.size(); ++i) {
      const std::uint64_t mask = random_();
      d[i] = (a[i] & mask) | (b[i] & ~mask);
    }
    return d;
  }
  /// As seen another time.
  Descriptor turned(Descriptor d) {
    const int bits = real_.bits_wrong[random_() % real_.bits_wrong.size()];
    for (int i = 0; i < bits; ++i) {
      const std::uint64_t bit = random_() % 256;
      d[bit / 64] ^= 1ULL << (bit % 64);
    }
    return d;
  }

  const BenchOptions& bench_;
  const Real& real_;
  Map& map_;
  std::mt19937_64 random_{1};
  int keyframes_ = 0;
  std::vector<int> window_;     // landmarks in view
  std::vector<int> generated_;  // keyframes
  std::map<int, Descriptor> true_look_;
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * double(values.size() - 1))];
}

struct Score {
  int asked = 0, found_first = 0, found = 0, placed = 0;
  std::vector<double> query_ms, relocalise_ms, error;

  double percent(int count) const { return 100.0 * count / std::max(asked, 1); }
};

Score ask_generated(const BenchOptions& bench, const Map& map, const PlaceIndex& places,
                    Generator& generator) {
  Score score;
  for (int i = 0; i < bench.queries; ++i) {
    int truth = -1;
    const std::vector<Descriptor> view = generator.view(truth);
    const ThreadTime watch;
    const auto found = places.query(map, view, 5);
    score.query_ms.push_back(watch.ms());
    const int around = bench.features / bench.new_features;
    const auto right = [&](const PlaceCandidate& c) {
      return std::abs(c.keyframe - truth) < around;
    };
    ++score.asked;
    score.found_first += !found.empty() && right(found.front());
    score.found += std::any_of(found.begin(), found.end(), right);
  }
  return score;
}

Score ask_real(const Real& real, const Map& map, const PlaceIndex& places) {
  constexpr double right_place = 0.05;  // metres and radians
  Score score;
  for (const Query& q : real.queries) {
    Frame frame = q.frame;
    const ThreadTime query_watch;
    const auto found = places.query(map, frame.features.descriptor, 5);
    score.query_ms.push_back(query_watch.ms());
    const auto right = [&](const PlaceCandidate& c) {
      return c.keyframe < real.map.keyframe_ids();
    };
    ++score.asked;
    score.found_first += !found.empty() && right(found.front());
    score.found += std::any_of(found.begin(), found.end(), right);
    const ThreadTime relocalise_watch;
    const bool placed = relocalize(map, places, {}, 1, frame);
    score.relocalise_ms.push_back(relocalise_watch.ms());
    if (!placed) continue;
    const Se3 wrong = frame.camera_from_world * q.camera_from_world.inverse();
    score.error.push_back(wrong.translation.norm());
    score.placed += wrong.translation.norm() < right_place && wrong.angle() < right_place;
  }
  return score;
}

void run(const BenchOptions& bench) {
  spdlog::set_level(spdlog::level::warn);
  const Real real = play(bench);
  fmt::print("real: {} keyframes, {} landmarks, {} frames ask; bits wrong: median {}, 90% {}\n",
             real.map.live_keyframes(), real.map.live_landmarks(), real.queries.size(),
             quantile({real.bits_wrong.begin(), real.bits_wrong.end()}, 0.5),
             quantile({real.bits_wrong.begin(), real.bits_wrong.end()}, 0.9));
  Map map = real.map;
  PlaceIndexOptions options;
  options.tables = bench.tables;
  PlaceIndex places(options);
  for (int k = 0; k < map.keyframe_ids(); ++k) {
    if (!map.keyframe(k).removed) places.add_keyframe(map, k);
  }
  Generator generator(bench, real, map);
  std::vector<double> add_ms;
  fmt::print(
      "keyframes landmarks  looks  MB | add ms | generated: query ms (99%), first %, of 5 % | "
      "real: query ms (99%), first %, of 5 %, placed %, relocalise ms (99%), error m\n");
  for (const int size : bench.keyframes) {
    while (map.live_keyframes() < size) {
      const int k = generator.add_keyframe();
      const ThreadTime watch;
      places.add_keyframe(map, k);
      add_ms.push_back(watch.ms());
    }
    const Score g = ask_generated(bench, map, places, generator), r = ask_real(real, map, places);
    fmt::print(
        "{:6} {:9} {:9} {:5.1f} | {:.2f} | {:.2f} ({:.2f}) {:.1f} {:.1f} | {:.2f} ({:.2f}) {:.1f} "
        "{:.1f} {:.1f} {:.2f} ({:.2f}) {:.4f}\n",
        map.live_keyframes(), map.live_landmarks(), places.size(), double(places.memory()) * 1e-6,
        quantile(add_ms, 0.5), quantile(g.query_ms, 0.5), quantile(g.query_ms, 0.99),
        g.percent(g.found_first), g.percent(g.found), quantile(r.query_ms, 0.5),
        quantile(r.query_ms, 0.99), r.percent(r.found_first), r.percent(r.found),
        r.percent(r.placed), quantile(r.relocalise_ms, 0.5), quantile(r.relocalise_ms, 0.99),
        quantile(r.error, 0.5));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace place

void add_place(CLI::App& program) {
  CLI::App* app =
      program.add_subcommand("place", "Measures place recognition in maps of growing size");
  const auto bench = std::make_shared<place::BenchOptions>();
  app->add_option("sequence", bench->sequence, "TUM folder")->required();
  app->add_option("--camera", bench->camera, "camera file")->required();
  app->add_option("--keyframes", bench->keyframes, "sizes of the map, growing")->delimiter(',');
  app->add_option("--features", bench->features, "of a generated keyframe")
      ->check(CLI::Range(100, 10000));
  app->add_option("--new-features", bench->new_features,
                  "of which the keyframe before has not seen")
      ->check(CLI::Range(1, 10000));
  app->add_option("--queries", bench->queries, "views of generated places that are asked for");
  app->add_option("--tables", bench->tables, "hash tables")->check(CLI::Range(1, 16));
  app->callback([bench] { place::run(*bench); });
}

}  // namespace dkp_slam::bench
