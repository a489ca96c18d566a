#include "dkp_slam/calibration/sighting_recorder.h"

#include <cmath>
#include <map>

namespace dkp_slam {

void SightingRecorder::on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) {
  if (!snapshot->result.localised) return;
  SightedFrame frame;
  frame.time = snapshot->frame.timestamp;
  frame.depth_time = frame.time + snapshot->frame.depth_delay;
  for (std::size_t i = 0; i < snapshot->landmarks.size(); ++i) {
    if (snapshot->landmarks[i] < 0) continue;
    const cv::KeyPoint& k = snapshot->keypoints[i];
    SeenLandmark seen;
    seen.landmark = snapshot->landmarks[i];
    seen.pixel = {k.pt.x, k.pt.y};
    seen.sigma = std::pow(level_scale_, k.octave);
    if (const auto place = place_in_depth(seen, frame.time, frame.depth_time))
      seen.depth = fit_depth_patch(snapshot->frame.depth, camera_, *place);
    frame.sightings.push_back(seen);
  }
  last_time_ = frame.time;
  last_at_.clear();
  for (const SeenLandmark& seen : frame.sightings) last_at_.emplace(seen.landmark, seen.pixel);
  frames_.push_back(std::move(frame));
}

std::optional<Eigen::Vector2d> SightingRecorder::place_in_depth(const SeenLandmark& seen,
                                                                double time,
                                                                double depth_time) const {
  constexpr double same = 1e-4;    // seconds
  constexpr double recent = 0.15;  // seconds: over more a speed says nothing of this moment
  // Elsewhere the patch's slope would be asked what the depth is there. Slopes are noisy, and a
  // noise that grows with the delay makes the least squares prefer a small one.
  const double delay = depth_time - time;
  if (std::abs(delay) < same) return seen.pixel;
  const auto last = last_at_.find(seen.landmark);
  const double passed = time - last_time_;
  if (last == last_at_.end() || !(passed > 0.0 && passed < recent)) return std::nullopt;
  return seen.pixel + delay / passed * (seen.pixel - last->second);
}

std::vector<SightedFrame> SightingRecorder::frames_on(const Trajectory& path) const {
  std::map<double, Se3> poses;
  for (const StampedPose& pose : path) poses.emplace(pose.timestamp, pose.world_from_camera);
  std::vector<SightedFrame> frames;
  for (const SightedFrame& frame : frames_) {
    const auto pose = poses.find(frame.time);
    if (pose == poses.end()) continue;
    frames.push_back(frame);
    frames.back().world_from_camera = pose->second;
  }
  return frames;
}

}  // namespace dkp_slam
