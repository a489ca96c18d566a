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
    seen.depth = fit_depth_patch(snapshot->frame.depth, camera_, seen.pixel);
    frame.sightings.push_back(seen);
  }
  frames_.push_back(std::move(frame));
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
