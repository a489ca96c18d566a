#include "dkp_slam/localization/pose_refinement.h"

namespace dkp_slam {

Observation observation_of(const FrameFeatures& features, int feature, const Map& map,
                           const MeasurementModel& model) {
  const auto s = static_cast<std::size_t>(feature);
  return {{features.pixel[s].x, features.pixel[s].y},
          features.depth[s],
          model.pixel_sigma * map.scale_of(features.level[s])};
}

std::vector<PoseObservation> observations_of(const Frame& frame,
                                             const std::vector<FrameMatch>& matches, const Map& map,
                                             const MeasurementModel& model) {
  std::vector<PoseObservation> observations;
  observations.reserve(matches.size());
  for (const FrameMatch& m : matches) {
    observations.push_back({m.position, observation_of(frame.features, m.feature, map, model)});
  }
  return observations;
}

int refine_pose(const Map& map, const MeasurementModel& model, Frame& frame,
                std::vector<FrameMatch>& matches) {
  const std::vector<PoseObservation> observations = observations_of(frame, matches, map, model);
  const PoseEstimate estimate =
      optimize_pose(map.camera(), model, frame.camera_from_world, observations);
  frame.camera_from_world = estimate.camera_from_world;
  std::vector<FrameMatch> kept;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (estimate.inlier[i]) kept.push_back(matches[i]);
  }
  matches = std::move(kept);
  return estimate.inliers;
}

}  // namespace dkp_slam
