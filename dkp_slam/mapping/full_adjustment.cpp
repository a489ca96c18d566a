#include "dkp_slam/mapping/full_adjustment.h"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "dkp_slam/mapping/later_keyframes.h"
#include "dkp_slam/mapping/local_bundle.h"

namespace dkp_slam {

FullAdjustment::FullAdjustment(const Camera& camera, const MeasurementModel& model,
                               const FullAdjustmentOptions& options, bool realtime)
    : camera_(camera),
      model_(model),
      options_(options),
      realtime_(realtime),
      worker_(
          "full adjustment",
          [this](FullBundle bundle, const std::atomic<bool>& stop) {
            return solve(std::move(bundle), stop);
          },
          realtime) {}

void FullAdjustment::start(const Map& map, int keyframe) {
  stop();
  if (map.live_keyframes_in(map.keyframe(keyframe).map) < 2) return;
  while (map.keyframe(keyframe).removed) keyframe = map.keyframe(keyframe).parent;
  snapshot_.emplace(map, keyframe, options_.most_sightings);
}

void FullAdjustment::advance(Map& map, int frame_index) {
  remove_outliers(map, options_.outliers_per_frame);
  if (!snapshot_ || !snapshot_->gather(map, model_, options_.sightings_per_frame)) return;
  if (snapshot_->cut()) {
    spdlog::info("whole map too large to be adjusted: its {} keyframes about the loop are",
                 snapshot_->keyframes());
  }
  due_frame_ = frame_index + options_.delay + static_cast<int>(snapshot_->keyframes());
  worker_.submit(std::move(*snapshot_));
  snapshot_.reset();
}

bool FullAdjustment::due(int frame_index) const {
  return worker_.pending() && (realtime_ ? worker_.finished() : frame_index >= due_frame_);
}

FullAdjustment::Solution FullAdjustment::solve(FullBundle bundle,
                                               const std::atomic<bool>& stop) const {
  const int first_later = bundle.first_later();
  const BundleProblem problem = std::move(bundle).take();
  BundleOptions options;
  options.iterations = options_.iterations;
  BundleSolution solved = adjust_bundle(camera_, model_, problem, options, &stop);
  Solution solution{problem.poses, std::move(solved.poses), {}, {}, first_later, solved.usable};
  const auto by_keyframe = [](const auto& a, const auto& b) { return a.keyframe < b.keyframe; };
  std::sort(solution.before.begin(), solution.before.end(), by_keyframe);
  std::sort(solution.after.begin(), solution.after.end(), by_keyframe);
  for (const BundleProblem::Point& p : solved.points)
    solution.landmarks.push_back({p.landmark, p.position});
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    if (!solved.outlier[i]) continue;
    const BundleProblem::Sighting& s = problem.sightings[i];
    solution.outliers.push_back({problem.points[static_cast<std::size_t>(s.point)].landmark,
                                 problem.poses[static_cast<std::size_t>(s.pose)].keyframe});
  }
  return solution;
}

void FullAdjustment::carry_back(Map& map) {
  Solution solution = worker_.take();
  if (!solution.usable) return;
  MapMove move;
  for (std::size_t i = 0; i < solution.after.size(); ++i) {
    const BundleProblem::Pose& after = solution.after[i];
    const Keyframe& keyframe = map.keyframe(after.keyframe);
    const Se3 before =
        keyframe.removed ? solution.before[i].camera_from_world : keyframe.camera_from_world;
    move.keyframes.push_back({after.keyframe, after.camera_from_world.inverse() * before, {}});
  }
  move.landmarks = std::move(solution.landmarks);
  spdlog::debug("whole map adjusted: {} keyframes, {} landmarks", move.keyframes.size(),
                move.landmarks.size());
  move_with_later_keyframes(map, std::move(move), solution.first_later);
  outliers_.insert(outliers_.end(), solution.outliers.begin(), solution.outliers.end());
  ++done_;
}

void FullAdjustment::remove_outliers(Map& map, std::size_t most) {
  for (; most > 0 && !outliers_.empty(); --most, outliers_.pop_front()) {
    const auto [landmark, keyframe] = outliers_.front();
    if (!map.has_landmark(landmark) || map.keyframe(keyframe).removed) continue;
    map.remove_sighting(landmark, keyframe);
    if (map.has_landmark(landmark)) map.refresh(landmark);
  }
}

void FullAdjustment::stop() {
  worker_.abandon();
  snapshot_.reset();
}

void adjust_map(Map& map, const MeasurementModel& model, int which, int iterations,
                const std::atomic<bool>* stop, std::size_t most_sightings) {
  if (map.live_keyframes_in(which) < 2) return;
  BundleOptions options;
  options.iterations = iterations;
  const BundleProblem problem = full_bundle(map, model, which, most_sightings);
  apply_bundle(map, problem, adjust_bundle(map.camera(), model, problem, options, stop));
}

}  // namespace dkp_slam
