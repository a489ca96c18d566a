// Times of single stages on generated input: two people walk through the synthetic world before a
// camera that moves along freiburg3_walking_halfsphere's kind of path. Input is prepared outside
// the timed part.

#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/detection/class_table.h"
#include "dkp_slam/dynamics/dynamics_module.h"
#include "dkp_slam/feature/frame_features.h"
#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/optimization/bundle_adjustment.h"
#include "dkp_slam/optimization/pose_optimizer.h"
#include "dkp_slam/optimization/test_scene.h"
#include "dkp_slam/synth/source.h"

namespace dkp_slam {
namespace {

constexpr int person_class = 0;  // of COCO

struct Recorded {
  RgbdFrame frame;
  cv::Mat grey;
  OrbFeatures orb;
  std::vector<Detection> detections;
};

/// Boxes about the true people, as a good detector gives them.
std::vector<Detection> detections_of(const cv::Mat& mask) {
  cv::Mat labels, statistics, centres;
  const int regions = cv::connectedComponentsWithStats(mask, labels, statistics, centres);
  const ClassTable classes;
  std::vector<Detection> detections;
  for (int i = 1; i < regions; ++i) {
    const auto at = [&](int column) { return static_cast<float>(statistics.at<int>(i, column)); };
    Detection d;
    d.class_id = person_class;
    d.score = 0.9F;
    d.weight = classes.weight(person_class);
    d.box = {at(cv::CC_STAT_LEFT), at(cv::CC_STAT_TOP), at(cv::CC_STAT_WIDTH),
             at(cv::CC_STAT_HEIGHT)};
    if (d.box.area() > 1000.0F) detections.push_back(d);
  }
  return detections;
}

/// A second of the world. Made once: rendering takes longer than all stages.
const std::vector<Recorded>& recorded() {
  static const std::vector<Recorded> all = [] {
    SyntheticOptions options = synthetic_scenario("walking_halfsphere");
    options.frames = 30;
    SyntheticSource source(options);
    OrbExtractor orb;
    std::vector<Recorded> frames;
    while (std::optional<RgbdFrame> frame = source.read()) {
      Recorded r;
      r.frame = std::move(*frame);
      cv::cvtColor(r.frame.colour, r.grey, cv::COLOR_BGR2GRAY);
      r.orb = orb.extract(r.grey);
      r.detections = detections_of(source.truth().mask);
      frames.push_back(std::move(r));
    }
    return frames;
  }();
  return all;
}

/// Goes round and round through the recorded frames.
const Recorded& nth(std::size_t i) { return recorded()[i % recorded().size()]; }

void orb_extraction(benchmark::State& state) {
  recorded();
  OrbExtractor orb;
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(orb.extract(nth(i++).grey));
}
BENCHMARK(orb_extraction)->Unit(benchmark::kMillisecond);

void frame_features(benchmark::State& state) {
  recorded();
  const Camera camera = SyntheticOptions::default_camera();
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(FrameFeatures(nth(i).orb, nth(i).frame.depth, camera));
    ++i;
  }
}
BENCHMARK(frame_features)->Unit(benchmark::kMillisecond);

void flow(benchmark::State& state) {
  BackwardFlow flow{FlowOptions{}};
  flow.push(nth(0).grey);
  flow.push(nth(1).grey);
  std::vector<cv::Point2f> points;
  for (const cv::KeyPoint& k : nth(1).orb.keypoints) points.push_back(k.pt);
  for (auto _ : state) benchmark::DoNotOptimize(flow.track(points, 1, {}));
  state.counters["points"] = static_cast<double>(points.size());
}
BENCHMARK(flow)->Unit(benchmark::kMillisecond);

/// The dynamics room on consecutive frames; the counters tell clustering from removal.
void dynamics(benchmark::State& state, DynamicsMode mode) {
  recorded();
  DynamicsOptions options;
  options.mode = mode;
  DynamicsModule module(SyntheticOptions::default_camera(), options);
  std::size_t i = 0;
  double clustering_ms = 0.0, removal_ms = 0.0;
  for (auto _ : state) {
    if (i % recorded().size() == 0) {
      // Time must not run backwards within one module.
      state.PauseTiming();
      module = DynamicsModule(SyntheticOptions::default_camera(), options);
      state.ResumeTiming();
    }
    const Recorded& r = nth(i++);
    const FrameDynamics result =
        module.process(r.frame, r.grey, r.orb.keypoints, {r.frame.timestamp, true, r.detections});
    clustering_ms += result.clustering_ms;
    removal_ms += result.removal_ms;
  }
  const auto mean = [](double sum) {
    return benchmark::Counter(sum, benchmark::Counter::kAvgIterations);
  };
  state.counters["clustering_ms"] = mean(clustering_ms);
  state.counters["removal_ms"] = mean(removal_ms);
}
BENCHMARK_CAPTURE(dynamics, dk, DynamicsMode::dk)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(dynamics, dkp, DynamicsMode::dkp)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(dynamics, dkp_plus, DynamicsMode::dkp_plus)->Unit(benchmark::kMillisecond);

void pose_optimisation(benchmark::State& state) {
  testing::Scene scene(static_cast<int>(state.range(0)));
  const Se3 truth = scene.random_pose(0.1, 0.1);
  const Se3 start = scene.random_pose(0.02, 0.01) * truth;
  std::normal_distribution<double> noise(0.0, 0.7);
  std::vector<PoseObservation> observations;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    Observation seen = scene.exact(truth, scene.points[i]);
    seen.pixel += Eigen::Vector2d(noise(scene.random), noise(scene.random));
    if (i % 10 == 0) seen.pixel.x() += 30.0;  // a wrong match
    observations.push_back({scene.points[i], seen});
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(optimize_pose(scene.camera, MeasurementModel{}, start, observations));
  }
}
BENCHMARK(pose_optimisation)->Arg(300)->Arg(1000)->Unit(benchmark::kMicrosecond);

/// As many keyframes and landmarks as the local window has at most; the first keyframes stay.
void local_bundle_adjustment(benchmark::State& state) {
  constexpr int keyframes = 40, fixed = 24;
  testing::Scene scene(static_cast<int>(state.range(0)));
  std::normal_distribution<double> noise(0.0, 0.7);
  BundleProblem problem;
  for (int k = 0; k < keyframes; ++k) {
    const Se3 truth = scene.random_pose(0.2, 0.05);
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      if ((i + static_cast<std::size_t>(k)) % 4 != 0) continue;  // each keyframe sees a quarter
      Observation seen = scene.exact(truth, scene.points[i]);
      seen.pixel += Eigen::Vector2d(noise(scene.random), noise(scene.random));
      problem.sightings.push_back({k, static_cast<int>(i), seen});
    }
    const bool stays = k < fixed;
    problem.poses.push_back({k, stays ? truth : scene.random_pose(0.01, 0.005) * truth, stays});
  }
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    problem.points.push_back(
        {static_cast<int>(i), scene.points[i] + 0.02 * Eigen::Vector3d::Random()});
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(adjust_bundle(scene.camera, MeasurementModel{}, problem));
  }
  state.counters["sightings"] = static_cast<double>(problem.sightings.size());
}
BENCHMARK(local_bundle_adjustment)->Arg(1000)->Arg(3000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dkp_slam

BENCHMARK_MAIN();
