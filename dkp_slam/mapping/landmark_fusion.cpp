#include "dkp_slam/mapping/landmark_fusion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dkp_slam/localization/pose_refinement.h"

namespace dkp_slam {
namespace {

constexpr int neighbours = 8;      // keyframes
constexpr int bits_apart = 50;     // descriptors of one landmark
constexpr float radius_px = 3.0F;  // on level 0

/// The keyframe's feature that shows the landmark, -1 for none.
int find_in(const Map& map, const MeasurementModel& model, const Landmark& landmark,
            const Keyframe& keyframe, std::vector<int>& candidates) {
  const Camera& camera = map.camera();
  const Eigen::Vector3d p = keyframe.camera_from_world * landmark.position;
  if (p.z() <= 0.0) return -1;
  const Eigen::Vector2d pixel = camera.project(p);
  if (pixel.x() < 0.0 || pixel.y() < 0.0 || pixel.x() >= camera.width || pixel.y() >= camera.height)
    return -1;
  const Eigen::Vector3d ray = landmark.position - keyframe.camera_from_world.inverse().translation;
  const double distance = ray.norm();
  if (distance < 0.8 * landmark.min_distance || distance > 1.2 * landmark.max_distance) return -1;
  if (ray.dot(landmark.normal) < 0.5 * distance) return -1;
  const int level = map.predicted_level(landmark, distance);
  const FrameFeatures& features = keyframe.features;
  features.find(cv::Point2f(float(pixel.x()), float(pixel.y())), radius_px * map.scale_of(level),
                level - 1, level, candidates);
  std::erase_if(candidates, [&](int c) {
    const Observation seen = observation_of(features, c, map, model);
    if ((pixel - seen.pixel).squaredNorm() > model.pixel_chi2 * seen.pixel_sigma * seen.pixel_sigma)
      return true;
    return seen.depth > 0.0 &&
           std::abs(seen.depth - p.z()) > 0.05 + 4.0 * model.depth_sigma(camera, p.z());
  });
  const NearestTwo nearest = nearest_two(landmark.descriptor, features.descriptor, candidates);
  return nearest.best_distance <= bits_apart ? nearest.best : -1;
}

/// Looks for a landmark in a keyframe; true where that changed the map.
bool fuse_into(Map& map, const MeasurementModel& model, int id, int keyframe,
               std::vector<int>& candidates) {
  if (!map.has_landmark(id)) return false;
  const Landmark& landmark = map.landmark(id);
  if (landmark.feature_in(keyframe) >= 0) return false;
  const int feature = find_in(map, model, landmark, map.keyframe(keyframe), candidates);
  if (feature < 0) return false;
  const int present = map.keyframe(keyframe).landmarks[static_cast<std::size_t>(feature)];
  if (present < 0) {
    map.add_sighting(id, keyframe, feature);
    map.refresh(id);
  } else if (map.landmark(present).sightings.size() > landmark.sightings.size()) {
    map.fuse_landmarks(id, present);
  } else {
    map.fuse_landmarks(present, id);
  }
  return true;
}

}  // namespace

NeighbourFusion::NeighbourFusion(const Map& map, int keyframe)
    : keyframe_(keyframe), others_(map.best_covisible(keyframe, neighbours)) {}

bool NeighbourFusion::advance(Map& map, const MeasurementModel& model, int& effort) {
  for (; step_ <= others_.size(); ++step_, listed_ = false) {
    const bool last = step_ == others_.size();
    if (!listed_) {
      if (effort <= 0) return false;
      effort -= effort::keyframe;
      landmarks_ = map.landmarks_of(last ? others_ : std::vector<int>{keyframe_});
      next_ = 0;
      listed_ = true;
    }
    if (!fuse(map, model, last ? keyframe_ : others_[step_], effort)) return false;
  }
  return true;
}

bool NeighbourFusion::fuse(Map& map, const MeasurementModel& model, int into, int& effort) {
  std::vector<int> candidates;
  for (; next_ < landmarks_.size(); ++next_) {
    if (effort <= 0) return false;
    if (map.keyframe(into).removed) break;
    const bool fused = fuse_into(map, model, landmarks_[next_], into, candidates);
    effort -= fused ? effort::fusion : effort::search;
  }
  return true;
}

void fuse_with_neighbours(Map& map, const MeasurementModel& model, int keyframe) {
  int unlimited = std::numeric_limits<int>::max();
  NeighbourFusion(map, keyframe).advance(map, model, unlimited);
}

}  // namespace dkp_slam
