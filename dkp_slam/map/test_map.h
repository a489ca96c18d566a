#pragma once

#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "dkp_slam/map/map_snapshot.h"

namespace dkp_slam::testing {

inline Camera test_camera() {
  Camera camera;
  camera.name = "test";
  camera.fx = camera.fy = 500.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.distortion.k1 = 0.1;
  camera.readout = 0.02;
  camera.depth_readout = 0.01;
  return camera;
}

/// A map in which happens what happens in a run, a bit of everything in each step: keyframes and
/// landmarks come, move and go, and other maps begin. The same steps make the same map.
class GrowingMap {
 public:
  explicit GrowingMap(int features = 100) : features_(features) { step(); }

  Map map{test_camera(), 1.2F, 8};

  /// Steps so far; the first keyframe's pose tells the same.
  int steps() const { return steps_; }
  static int steps_of(const Map& map) {
    return map.keyframe_ids() == 0
               ? 0
               : static_cast<int>(map.keyframe(0).camera_from_world.translation.x());
  }
  void grow_to(int steps) {
    while (steps_ < steps) step();
  }

  void step() {
    if (steps_ % 20 == 19) map.start_map();
    add_keyframe();
    const int newest = map.keyframe_ids() - 1;
    for (int k = newest; k > 0 && k > newest - 5; --k) {
      map.keyframe(k).camera_from_world.translation.y() += 0.001 * uniform();
    }
    for (const int l : map.landmarks_of({newest})) {
      Landmark& landmark = map.landmark(l);
      landmark.position.z() += 0.01 * uniform();
      ++landmark.visible;
      landmark.found += uniform() > 0.5;
      landmark.dynamic_log_odds -= 0.1F;
    }
    const std::vector<int> seen = map.landmarks_of({newest});
    map.remove_landmark(seen[seen.size() / 2]);
    map.fuse_landmarks(seen[3], seen[4]);
    const int old = newest - 4;
    if (steps_ % 3 == 0 && old > 0 && map.keyframe(old).parent >= 0) map.remove_keyframe(old);
    if (steps_ % 50 == 49) map.move_map(1, 0, Se3(Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0}));
    map.keyframe(0).camera_from_world.translation.x() = ++steps_;
  }

 private:
  double uniform() { return double(random_() >> 11) * 0x1p-53; }

  void add_keyframe() {
    const int last = map.keyframe_ids() - 1;
    Keyframe k;
    k.frame_index = 10 * steps_;
    k.timestamp = 100.0 + steps_ / 30.0;
    k.camera_from_world =
        Se3(Eigen::Quaterniond(Eigen::AngleAxisd(uniform(), Eigen::Vector3d::UnitY())),
            {0.1 * steps_, uniform(), uniform()});
    std::vector<cv::Point2f> pixel;
    std::vector<float> depth, angle;
    std::vector<std::uint8_t> level;
    std::vector<Descriptor> descriptor;
    std::vector<int> known;
    if (last >= 0 && map.keyframe(last).map == map.current_map()) known = map.landmarks_of({last});
    for (int f = 0; f < features_; ++f) {
      pixel.emplace_back(float(640.0 * uniform()), float(480.0 * uniform()));
      depth.push_back(f % 5 == 0 ? 0.0F : float(1.0 + uniform()));
      angle.push_back(float(360.0 * uniform()));
      level.push_back(static_cast<std::uint8_t>(random_() % 8));
      descriptor.push_back({random_(), random_(), random_(), random_()});
      const auto s = static_cast<std::size_t>(f);
      k.landmarks.push_back(2 * f < features_ && s < known.size() ? known[s] : -1);
    }
    k.features = FrameFeatures(map.camera(), pixel, depth, level, angle, descriptor);
    const int id = map.add_keyframe(std::move(k));
    for (int f = 0; f < features_; ++f) {
      const auto s = static_cast<std::size_t>(f);
      if (map.keyframe(id).landmarks[s] < 0 && depth[s] > 0.0F)
        map.add_landmark({uniform(), uniform(), 1.0 + uniform()}, id, f);
    }
    map.update_covisibility(id);
  }

  const int features_;
  int steps_ = 0;
  std::mt19937_64 random_{5};
};

/// The first thing in which two maps differ that should be the same; empty when nothing does.
inline std::string difference(const MapParts& a, const MapParts& b) {
  if (const auto camera = difference_of(a.camera, b.camera)) return *camera;
  if (a.camera.name != b.camera.name) return "camera name";
  if (a.level_scale != b.level_scale || a.levels != b.levels) return "pyramid";
  if (a.keyframe_ids != b.keyframe_ids || a.landmark_ids != b.landmark_ids) return "ids";
  if (a.maps != b.maps || a.current_map != b.current_map) return "maps";
  if (a.keyframes.size() != b.keyframes.size() || a.landmarks.size() != b.landmarks.size())
    return fmt::format("{} keyframes and {} landmarks, not {} and {}", b.keyframes.size(),
                       b.landmarks.size(), a.keyframes.size(), a.landmarks.size());
  for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
    const Keyframe &x = a.keyframes[i], &y = b.keyframes[i];
    const FrameFeatures &f = x.features, &g = y.features;
    const bool same =
        x.id == y.id && x.map == y.map && x.frame_index == y.frame_index &&
        x.timestamp == y.timestamp && x.parent == y.parent && x.landmarks == y.landmarks &&
        x.camera_from_world.translation == y.camera_from_world.translation &&
        x.camera_from_world.rotation.coeffs() == y.camera_from_world.rotation.coeffs();
    if (!same) return fmt::format("keyframe {}", x.id);
    if (f.pixel != g.pixel || f.depth != g.depth || f.level != g.level || f.angle != g.angle ||
        f.descriptor != g.descriptor)
      return fmt::format("features of keyframe {}", x.id);
  }
  for (std::size_t i = 0; i < a.landmarks.size(); ++i) {
    const Landmark &x = a.landmarks[i], &y = b.landmarks[i];
    const bool same = x.id == y.id && x.position == y.position &&
                      x.first_keyframe == y.first_keyframe && x.visible == y.visible &&
                      x.found == y.found && x.dynamic_log_odds == y.dynamic_log_odds;
    if (!same) return fmt::format("landmark {}", x.id);
  }
  return "";
}

inline std::string difference(const Map& a, const Map& b) {
  return difference(parts_of(a), parts_of(b));
}

}  // namespace dkp_slam::testing
