#include "dkp_slam/mapping/mapper.h"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "dkp_slam/localization/matcher.h"
#include "dkp_slam/mapping/landmark_fusion.h"

namespace dkp_slam {

Mapper::Mapper(Map& map, PlaceIndex& places, const MeasurementModel& model,
               const MapperOptions& options, bool realtime)
    : map_(map),
      places_(places),
      model_(model),
      options_(options),
      realtime_(realtime),
      full_adjustment_(map.camera(), model, options.full, realtime),
      worker_(
          "adjustment",
          [camera = map.camera(), model, bundle = options.bundle](BundleProblem problem,
                                                                  const std::atomic<bool>& stop) {
            BundleSolution solution = adjust_bundle(camera, model, problem, bundle, &stop);
            return Adjusted{std::move(problem), std::move(solution)};
          },
          realtime) {}

int Mapper::insert_keyframe(Frame& frame) {
  wait();
  // Ids from before the last keyframe are held by the index alone: all frames that may still be
  // asked about were localised since.
  map_.forget_fusions(places_.followed_fusions());
  Keyframe keyframe;
  keyframe.frame_index = frame.index;
  keyframe.timestamp = frame.timestamp;
  keyframe.camera_from_world = frame.camera_from_world;
  const int reference = frame.reference_keyframe;
  keyframe.features = frame.features.subset(frame.is_static);
  resolve_landmarks(map_, frame);
  std::vector<int> feature_of_frame;  // of the keyframe's features
  for (int i = 0; i < frame.features.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    if (!frame.is_static[s]) continue;
    feature_of_frame.push_back(i);
    keyframe.landmarks.push_back(frame.landmark[s]);
  }
  const int id = map_.add_keyframe(std::move(keyframe));
  frame.reference_keyframe = id;
  map_.update_covisibility(id);
  create_landmarks(frame, id, feature_of_frame);
  cull_landmarks(id);
  fuse_with_neighbours(map_, model_, id);
  map_.update_covisibility(id);
  // A frame that was carried shares nothing with its map; the motion that led there links it.
  Keyframe& made = map_.keyframe(id);
  if (made.parent < 0 && reference >= 0 && map_.keyframe(reference).map == made.map) {
    made.parent = reference;
  }
  cull_keyframes(id);
  places_.add_keyframe(map_, id);
  return id;
}

void Mapper::adjust_around(int keyframe, int frame_index) {
  if (map_.live_keyframes_in(map_.current_map()) < 2) return;
  due_frame_ = frame_index + options_.bundle_delay;
  worker_.submit(local_bundle(map_, model_, keyframe, options_.local));
}

void Mapper::create_landmarks(Frame& frame, int id, const std::vector<int>& feature_of_frame) {
  const Camera& camera = map_.camera();
  const FrameFeatures& features = map_.keyframe(id).features;
  const Se3 world_from_camera = frame.camera_from_world.inverse();
  // Far ones too, where ORB-SLAM2 takes only a few: the weights know how uncertain their depth is,
  // and in a room seen past people they are often most of what is static.
  for (int f = 0; f < features.size(); ++f) {
    const auto s = static_cast<std::size_t>(f);
    const float depth = features.depth[s];
    if (depth <= 0.0F || map_.keyframe(id).landmarks[s] >= 0) continue;
    const cv::Point2f& p = features.pixel[s];
    const int landmark =
        map_.add_landmark(world_from_camera * camera.unproject({p.x, p.y}, depth), id, f);
    frame.landmark[static_cast<std::size_t>(feature_of_frame[s])] = landmark;
    recent_landmarks_.push_back(landmark);
  }
}

void Mapper::cull_landmarks(int newest) {
  // A landmark must be found in a quarter of the frames that should see it, and after two more
  // keyframes be seen by two, to stay (Mur-Artal et al. 2015, §VI-B).
  std::erase_if(recent_landmarks_, [&](int id) {
    if (!map_.has_landmark(id)) return true;
    const Landmark& l = map_.landmark(id);
    const int age = newest - l.first_keyframe;
    if (4 * l.found < l.visible || (age >= 2 && l.sightings.size() < 2)) {
      map_.remove_landmark(id);
      return true;
    }
    return age >= 3;
  });
}

void Mapper::cull_keyframes(int newest) {
  for (const int id : map_.best_covisible(newest, map_.keyframe_ids())) {
    const Keyframe& k = map_.keyframe(id);
    if (id == 0 || k.parent < 0) continue;
    int total = 0, redundant = 0;
    for (std::size_t f = 0; f < k.landmarks.size(); ++f) {
      if (k.landmarks[f] < 0) continue;
      ++total;
      int others = 0;
      for (const Sighting& s : map_.landmark(k.landmarks[f]).sightings) {
        if (s.keyframe == id) continue;
        const auto level =
            map_.keyframe(s.keyframe).features.level[static_cast<std::size_t>(s.feature)];
        if (level <= k.features.level[f] + 1 && ++others == 3) break;
      }
      redundant += others == 3;
    }
    if (redundant > options_.redundant_share * total) map_.remove_keyframe(id);
  }
}

void Mapper::advance(int frame_index) {
  full_adjustment_.advance(map_, frame_index);
  const bool full_is_due = full_adjustment_.due(frame_index);
  if (worker_.pending() &&
      (realtime_ ? worker_.finished() : full_is_due || frame_index >= due_frame_))
    carry_back();
  if (full_is_due && !worker_.pending()) full_adjustment_.carry_back(map_);
}

bool Mapper::make_way_for_move() {
  if (worker_.pending() && realtime_ && !worker_.finished()) return false;
  wait();
  full_adjustment_.stop();
  return true;
}

void Mapper::carry_back() {
  const Adjusted adjusted = worker_.take();
  apply_bundle(map_, adjusted.problem, adjusted.solution);
}

void Mapper::finish(bool full_adjustment, const std::atomic<bool>* stop) {
  full_adjustment_.stop();
  full_adjustment_.finish(map_);
  wait();
  if (!full_adjustment) return;
  for (int which = 0; which < map_.maps(); ++which) {
    if (stop && *stop) return;
    adjust_map(map_, model_, which, options_.full.iterations, stop, options_.full.most_sightings);
  }
}

}  // namespace dkp_slam
