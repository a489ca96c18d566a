#include "dkp_slam/system/engine.h"

#include <algorithm>

#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/stopwatch.h"
#include "dkp_slam/trace.h"

namespace dkp_slam {
namespace {

const SlamConfig& checked(const SlamConfig& config) {
  config.check();
  return config;
}

/// The mode may go without what is ours in tracking, too.
TrackerOptions tracker_options(const SlamConfig& all) {
  TrackerOptions options = all.tracking;
  const bool own = mode_info(all.dynamics.mode).own_tracking;
  options.use_belief = options.use_belief && own;
  // Mode off is the baseline, which knows nothing of people.
  options.find_room = options.find_room && own && all.dynamics.mode != DynamicsMode::off;
  return options;
}

FeatureRefillOptions refill_options(const SlamConfig& all) {
  FeatureRefillOptions options = all.refill;
  if (!mode_info(all.dynamics.mode).own_tracking) options.below = options.known_below = 0;
  return options;
}

PathSmootherOptions smoother_options(const SlamConfig& all) {
  PathSmootherOptions options = all.path;
  options.smooth = options.smooth && mode_info(all.dynamics.mode).own_tracking;
  return options;
}

}  // namespace

Engine::Engine(const SlamConfig& config, std::optional<Map> stored)
    : config_(checked(config)),
      map_(stored ? std::move(*stored) : Map(config.camera, config.orb.scale, config.orb.levels)),
      first_keyframe_(map_.keyframe_ids()),
      places_(config.places),
      back_end_(map_, places_, config.measurement,
                {config.mapping, config.loop, config.close_loops}, config.realtime, config.seed),
      tracker_(map_, places_, config.measurement, tracker_options(config), config.localize_only,
               config.seed),
      dynamics_(config.camera, config.dynamics, config.seed),
      refill_(config.orb, refill_options(config)),
      start_(map_),
      self_check_(map_, config.measurement) {
  for (int k = 0; k < first_keyframe_; ++k) {
    if (!map_.keyframe(k).removed) places_.add_keyframe(map_, k);
  }
}

std::shared_ptr<FrameSnapshot> Engine::track(PreparedFrame prepared) {
  auto snapshot = std::make_shared<FrameSnapshot>();
  FrameResult& result = snapshot->result;
  result.index = prepared.frame.index;
  result.timestamp = prepared.frame.timestamp;
  result.decode_ms = prepared.frame.decode_ms;
  result.feature_ms = prepared.feature_ms;
  result.detection_ms = prepared.detection_ms;

  snapshot->dynamics =
      dynamics_.process(prepared.frame, prepared.grey, prepared.orb.keypoints, prepared.detections);
  {
    const TraceSpan span("refill");
    const FeatureRefill::Room room{[&] { return dynamics_.known_static(prepared.grey); },
                                   [&](std::size_t first) {
                                     dynamics_.judge_added(prepared.frame, prepared.orb.keypoints,
                                                           first, snapshot->dynamics);
                                   }};
    refill_.refill(room, prepared.orb, snapshot->dynamics);
  }
  const FrameDynamics& dynamics = snapshot->dynamics;
  result.clustering_ms = dynamics.clustering_ms;
  result.removal_ms = dynamics.removal_ms;
  for (const Detection& d : prepared.detections.detections) {
    result.detections += d.score >= config_.dynamics.compensation.start_score;
  }
  for (const DynamicObject& o : dynamics.objects) result.compensated += o.compensated;
  localize(prepared, *snapshot);
  snapshot->frame = std::move(prepared.frame);
  snapshot->keypoints = std::move(prepared.orb.keypoints);
  snapshot->detections = std::move(prepared.detections);
  return snapshot;
}

void Engine::localize(const PreparedFrame& prepared, FrameSnapshot& snapshot) {
  const TraceSpan span("localise");
  const Stopwatch watch;
  Frame frame;
  frame.index = prepared.frame.index;
  frame.timestamp = prepared.frame.timestamp;
  frame.features = FrameFeatures(prepared.orb, prepared.frame.depth, config_.camera,
                                 tracker_.motion_over(prepared.frame.depth_delay));
  frame.current_from_previous = snapshot.dynamics.current_from_previous;
  frame.is_static.reserve(snapshot.dynamics.features.size());
  for (const FeatureDynamics& f : snapshot.dynamics.features)
    frame.is_static.push_back(f.is_static);
  back_end_.advance(frame.index);
  if (frame.current_from_previous && start_.waits_for(frame)) {
    start_.correct(frame, *frame.current_from_previous);
  }
  const TrackingResult tracked = tracker_.track(frame, back_end_.adjusting());
  if (tracked.keyframe_due) {
    back_end_.insert_keyframe(frame);
    if (!config_.localize_only && map_.live_keyframes_in(map_.current_map()) == 1) {
      start_.remember(frame, prepared.orb, prepared.frame);
    }
  }
  FrameResult& result = snapshot.result;
  if (tracked.localised) {
    const TrackedPose pose = tracker_.settle(frame, tracked.keyframe_due);
    poses_.add(pose);
    result.reference_keyframe = pose.reference_keyframe;
    result.camera_from_reference = pose.camera_from_reference;
  }
  result.tracking_ms = watch.ms();
  result.state = tracker_.state();
  result.localised = tracked.localised;
  result.keyframe = tracked.keyframe_due;
  if (result.localised) {
    result.world_from_camera = frame.camera_from_world.inverse();
    result.map = map_.keyframe(frame.reference_keyframe).map;
  }
  result.features = frame.features.size();
  for (const char s : frame.is_static) result.removed_features += !s;
  result.tracked_landmarks = tracker_.tracked_landmarks();
  result.quality =
      self_check_.check(frame, result.localised, result.tracked_landmarks, snapshot.dynamics);
  result.map_keyframes = map_.live_keyframes();
  result.map_landmarks = map_.live_landmarks();
  snapshot.landmarks = std::move(frame.landmark);
}

void Engine::finish(const std::atomic<bool>* stop) {
  back_end_.finish(config_.final_adjustment && !config_.localize_only, stop);
}

std::vector<int> Engine::maps_in_use() const {
  std::vector<int> frames(static_cast<std::size_t>(map_.maps()), 0), used;
  poses_.for_each([&](const TrackedPose& p) {
    const int which = map_.keyframe(p.reference_keyframe).map;
    if (frames[static_cast<std::size_t>(which)]++ == 0) used.push_back(which);
  });
  std::stable_sort(used.begin(), used.end(), [&](int a, int b) {
    return frames[static_cast<std::size_t>(a)] > frames[static_cast<std::size_t>(b)];
  });
  return used;
}

std::vector<Trajectory> Engine::trajectories() const {
  const std::vector<int> used = maps_in_use();
  std::vector<Trajectory> paths(used.size());
  std::vector<std::vector<PathPose>> tracked(used.size());
  std::size_t before = used.size();
  poses_.for_each([&](const TrackedPose& p) {
    const int which = map_.keyframe(p.reference_keyframe).map;
    const auto path =
        static_cast<std::size_t>(std::find(used.begin(), used.end(), which) - used.begin());
    tracked[path].push_back({p.timestamp,
                             p.camera_from_reference * map_.keyframe_pose(p.reference_keyframe),
                             path == before ? p.from_previous : std::nullopt, p.landmarks,
                             p.continues && path == before});
    paths[path].push_back({p.timestamp, {}});
    before = path;
  });
  const PathSmootherOptions smoothing = smoother_options(config_);
  for (std::size_t path = 0; path < paths.size(); ++path) {
    smooth_path(tracked[path], smoothing);
    for (std::size_t i = 0; i < paths[path].size(); ++i) {
      paths[path][i].world_from_camera = tracked[path][i].camera_from_world.inverse();
    }
  }
  return paths;
}

Trajectory Engine::keyframe_trajectory() const {
  Trajectory out;
  const std::vector<int> used = maps_in_use();
  if (used.empty()) return out;
  for (const int k : map_.keyframes_in(used.front())) {
    if (k < first_keyframe_) continue;
    out.push_back({map_.keyframe(k).timestamp, map_.keyframe(k).camera_from_world.inverse()});
  }
  return out;
}

}  // namespace dkp_slam
