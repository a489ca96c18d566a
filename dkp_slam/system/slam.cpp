#include "dkp_slam/system/slam.h"

#include <algorithm>

#include "dkp_slam/stopwatch.h"

namespace dkp_slam {
namespace {

DynamicsOptions dynamics_options(const SlamConfig& all) {
  DynamicsOptions options = all.dynamics;
  options.seed = all.seed;
  return options;
}

}  // namespace

Slam::Slam(const SlamConfig& options, std::optional<Map> stored)
    : options_(options),
      map_(stored ? std::move(*stored)
                  : Map(options.camera, options.orb.scale, options.orb.levels)),
      first_keyframe_(map_.keyframe_ids()),
      back_end_(map_, places_, options.measurement, options.back_end, options.realtime,
                options.seed),
      tracker_(map_, places_, options.measurement, options.tracker, options.localize_only,
               options.seed),
      dynamics_(options.camera, dynamics_options(options)) {
  for (int k = 0; k < first_keyframe_; ++k) {
    if (!map_.keyframe(k).removed) places_.add_keyframe(map_, k);
  }
}

FrameReport Slam::track(const PreparedFrame& prepared, FrameDynamics* dynamics_out) {
  FrameReport report;
  report.index = prepared.frame.index;
  report.timestamp = prepared.frame.timestamp;
  report.decode_ms = prepared.decode_ms;
  report.feature_ms = prepared.feature_ms;
  report.detection_ms = prepared.detection_ms;

  FrameDynamics dynamics =
      dynamics_.process(prepared.frame, prepared.grey, prepared.orb.keypoints, prepared.detections);
  report.clustering_ms = dynamics.clustering_ms;
  report.removal_ms = dynamics.removal_ms;
  for (const Detection& d : prepared.detections) {
    report.detections += d.score >= options_.dynamics.compensation.start_score;
  }
  for (const DynamicObject& o : dynamics.objects) report.compensated += o.compensated;

  const Stopwatch watch;
  Frame frame;
  frame.index = prepared.frame.index;
  frame.timestamp = prepared.frame.timestamp;
  frame.features = FrameFeatures(prepared.orb, prepared.frame.depth, options_.camera,
                                 tracker_.motion_over(prepared.frame.depth_delay));
  frame.current_from_previous = dynamics.current_from_previous;
  frame.is_static.reserve(dynamics.features.size());
  for (const FeatureDynamics& f : dynamics.features) frame.is_static.push_back(f.is_static);
  back_end_.advance(frame.index);
  const TrackingResult tracked = tracker_.track(frame, back_end_.adjusting());
  if (tracked.keyframe_due) back_end_.insert_keyframe(frame);
  if (tracked.localised) tracker_.settle(frame, tracked.keyframe_due);
  report.tracking_ms = watch.ms();

  report.features = frame.features.size();
  for (const char s : frame.is_static) report.removed_features += !s;
  report.tracked_landmarks = tracker_.tracked_landmarks();
  report.localised = tracked.localised;
  report.keyframe = tracked.keyframe_due;
  report.map_keyframes = map_.live_keyframes();
  report.map_landmarks = map_.live_landmarks();
  if (dynamics_out) *dynamics_out = std::move(dynamics);
  return report;
}

void Slam::finish(const std::atomic<bool>* stop) {
  back_end_.finish(options_.final_adjustment && !options_.localize_only, stop);
}

std::vector<int> Slam::maps_in_use() const {
  std::vector<int> frames(static_cast<std::size_t>(map_.maps()), 0), used;
  for (const TrackedPose& p : tracker_.poses()) {
    const int which = map_.keyframe(p.reference_keyframe).map;
    if (frames[static_cast<std::size_t>(which)]++ == 0) used.push_back(which);
  }
  std::stable_sort(used.begin(), used.end(), [&](int a, int b) {
    return frames[static_cast<std::size_t>(a)] > frames[static_cast<std::size_t>(b)];
  });
  return used;
}

std::vector<Trajectory> Slam::trajectories() const {
  const std::vector<int> used = maps_in_use();
  std::vector<Trajectory> paths(used.size());
  for (const TrackedPose& p : tracker_.poses()) {
    const int which = map_.keyframe(p.reference_keyframe).map;
    const auto path = std::find(used.begin(), used.end(), which) - used.begin();
    const Se3 camera_from_world =
        p.camera_from_reference * map_.keyframe_pose(p.reference_keyframe);
    paths[static_cast<std::size_t>(path)].push_back({p.timestamp, camera_from_world.inverse()});
  }
  return paths;
}

Trajectory Slam::trajectory() const {
  const std::vector<Trajectory> paths = trajectories();
  return paths.empty() ? Trajectory() : paths.front();
}

Trajectory Slam::keyframe_trajectory() const {
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
