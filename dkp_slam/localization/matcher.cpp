#include "dkp_slam/localization/matcher.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "dkp_slam/map/id_map.h"

namespace dkp_slam {
namespace {

/// Rotation between matched features must agree: a histogram of 30 bins, of which the best three
/// stay (Mur-Artal et al. 2015).
class RotationVote {
 public:
  void add(int match, float from_angle, float to_angle) {
    float turn = std::fmod(from_angle - to_angle + 360.0F, 360.0F);
    const auto bin = static_cast<std::size_t>(turn * bins / 360.0F) % bins;
    members_[bin].push_back(match);
  }
  /// Flags of matches to keep.
  std::vector<char> keep(std::size_t matches) const {
    std::array<std::size_t, bins> order;
    for (std::size_t i = 0; i < bins; ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return members_[a].size() > members_[b].size();
    });
    std::vector<char> flags(matches, 0);
    for (std::size_t i = 0; i < 3; ++i) {
      if (10 * members_[order[i]].size() < members_[order[0]].size()) break;
      for (const int m : members_[order[i]]) flags[static_cast<std::size_t>(m)] = 1;
    }
    return flags;
  }

 private:
  static constexpr std::size_t bins = 30;
  std::array<std::vector<int>, bins> members_;
};

/// One match per feature: the one with the nearer descriptor stays.
class MatchTable {
 public:
  explicit MatchTable(int features) : of_feature_(static_cast<std::size_t>(features), -1) {}
  void offer(const FrameMatch& match, float from_angle) {
    int& slot = of_feature_[static_cast<std::size_t>(match.feature)];
    if (slot >= 0 && matches_[static_cast<std::size_t>(slot)].distance <= match.distance) return;
    if (slot >= 0) {
      matches_[static_cast<std::size_t>(slot)] = match;
      angles_[static_cast<std::size_t>(slot)] = from_angle;
    } else {
      slot = static_cast<int>(matches_.size());
      matches_.push_back(match);
      angles_.push_back(from_angle);
    }
  }
  std::vector<FrameMatch> take_consistent(const Frame& frame) const {
    RotationVote vote;
    for (std::size_t i = 0; i < matches_.size(); ++i) {
      vote.add(static_cast<int>(i), angles_[i],
               frame.features.angle[static_cast<std::size_t>(matches_[i].feature)]);
    }
    const std::vector<char> keep = vote.keep(matches_.size());
    std::vector<FrameMatch> out;
    for (std::size_t i = 0; i < matches_.size(); ++i) {
      if (keep[i]) out.push_back(matches_[i]);
    }
    return out;
  }
  const std::vector<FrameMatch>& all() const { return matches_; }

 private:
  std::vector<int> of_feature_;
  std::vector<FrameMatch> matches_;
  std::vector<float> angles_;
};

bool in_image(const Camera& camera, const Eigen::Vector2d& p) {
  return p.x() >= 0.0 && p.y() >= 0.0 && p.x() < camera.width && p.y() < camera.height;
}

}  // namespace

void assign_landmarks(const std::vector<FrameMatch>& matches, Frame& frame) {
  std::fill(frame.landmark.begin(), frame.landmark.end(), -1);
  for (const FrameMatch& m : matches) {
    frame.landmark[static_cast<std::size_t>(m.feature)] = m.landmark;
  }
}

void resolve_landmarks(const Map& map, Frame& frame) {
  IdSet taken;
  for (int& id : frame.landmark) {
    id = map.resolve(id);
    if (id >= 0 && !taken.insert(id)) id = -1;
  }
}

bool has_each_landmark_once(const Map& map, const Frame& frame) {
  IdSet taken;
  return std::all_of(frame.landmark.begin(), frame.landmark.end(),
                     [&](int id) { return id < 0 || (map.has_landmark(id) && taken.insert(id)); });
}

std::vector<FrameMatch> match_last_frame(const Map& map, const Frame& last, const Frame& frame,
                                         float radius, const MatchOptions& options) {
  const Camera& camera = map.camera();
  const Se3 world_from_last = last.camera_from_world.inverse();
  const Eigen::Vector3d motion =
      last.camera_from_world * frame.camera_from_world.inverse().translation;
  const bool forward = motion.z() > camera.baseline, backward = -motion.z() > camera.baseline;
  MatchTable table(frame.features.size());
  std::vector<int> candidates;
  for (int i = 0; i < last.features.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    if (!last.is_static[s]) continue;
    FrameMatch match;
    match.landmark = last.landmark[s];
    if (match.landmark >= 0) {
      match.position = map.landmark(match.landmark).position;
    } else if (last.features.depth[s] > 0.0F) {
      const cv::Point2f& p = last.features.pixel[s];
      match.position = world_from_last * camera.unproject({p.x, p.y}, last.features.depth[s]);
    } else {
      continue;
    }
    const Eigen::Vector3d p = frame.camera_from_world * match.position;
    if (p.z() <= 0.0) continue;
    const Eigen::Vector2d pixel = camera.project(p);
    if (!in_image(camera, pixel)) continue;
    const int level = last.features.level[s];
    frame.features.find(cv::Point2f(float(pixel.x()), float(pixel.y())),
                        radius * map.scale_of(level), forward ? level : level - 1,
                        backward ? level : level + 1, candidates);
    std::erase_if(candidates, [&](int c) { return !frame.is_static[static_cast<std::size_t>(c)]; });
    const NearestTwo nearest =
        nearest_two(last.features.descriptor[s], frame.features.descriptor, candidates);
    if (nearest.best < 0 || nearest.best_distance > options.loose) continue;
    match.feature = nearest.best;
    match.distance = nearest.best_distance;
    table.offer(match, last.features.angle[s]);
  }
  return table.take_consistent(frame);
}

std::vector<VisibleLandmark> landmarks_in_view(const Map& map, const Frame& frame,
                                               const std::vector<int>& landmarks) {
  const Camera& camera = map.camera();
  const Eigen::Vector3d centre = frame.camera_from_world.inverse().translation;
  std::vector<VisibleLandmark> visible;
  for (const int id : landmarks) {
    const Landmark& l = map.landmark(id);
    const Eigen::Vector3d p = frame.camera_from_world * l.position;
    if (p.z() <= 0.0) continue;
    const Eigen::Vector2d pixel = camera.project(p);
    if (!in_image(camera, pixel)) continue;
    const Eigen::Vector3d ray = l.position - centre;
    const double distance = ray.norm();
    // A fifth beyond the levels' range, where descriptors still match.
    if (distance < 0.8 * l.min_distance || distance > 1.2 * l.max_distance) continue;
    const double cosine = ray.dot(l.normal) / distance;
    if (cosine < 0.5) continue;
    visible.push_back({id, pixel, map.predicted_level(l, distance), p.z(), cosine});
  }
  return visible;
}

std::vector<FrameMatch> match_visible(const Map& map, const Frame& frame,
                                      const std::vector<VisibleLandmark>& visible,
                                      float radius_factor, const MatchOptions& options) {
  MatchTable table(frame.features.size());
  std::vector<int> candidates;
  for (const VisibleLandmark& v : visible) {
    const Landmark& l = map.landmark(v.landmark);
    // The window of ORB-SLAM: narrow when seen straight on.
    const float radius =
        radius_factor * (v.view_cosine > 0.998 ? 2.5F : 4.0F) * map.scale_of(v.level);
    frame.features.find(cv::Point2f(float(v.pixel.x()), float(v.pixel.y())), radius, v.level - 1,
                        v.level, candidates);
    std::erase_if(candidates, [&](int c) {
      const auto s = static_cast<std::size_t>(c);
      if (frame.landmark[s] >= 0) return true;
      // Another depth is another thing; edges, where depth jumps a little, get a margin.
      const double depth = frame.features.depth[s];
      return depth > 0.0 && std::abs(depth - v.depth) > 0.1 + 0.1 * v.depth;
    });
    const NearestTwo nearest = nearest_two(l.descriptor, frame.features.descriptor, candidates);
    if (nearest.best < 0 || nearest.best_distance > options.loose) continue;
    const auto best = static_cast<std::size_t>(nearest.best);
    if (nearest.second >= 0 &&
        frame.features.level[best] ==
            frame.features.level[static_cast<std::size_t>(nearest.second)] &&
        float(nearest.best_distance) > options.ratio_projection * float(nearest.second_distance)) {
      continue;
    }
    table.offer({nearest.best, v.landmark, l.position, nearest.best_distance}, 0.0F);
  }
  return table.all();
}

std::vector<FrameMatch> match_keyframe(const Map& map, const Keyframe& keyframe, const Frame& frame,
                                       const MatchOptions& options) {
  std::vector<int> candidates;
  for (int i = 0; i < frame.features.size(); ++i) {
    if (frame.is_static[static_cast<std::size_t>(i)]) candidates.push_back(i);
  }
  MatchTable table(frame.features.size());
  for (std::size_t f = 0; f < keyframe.landmarks.size(); ++f) {
    const int id = keyframe.landmarks[f];
    if (id < 0) continue;
    const NearestTwo nearest =
        nearest_two(keyframe.features.descriptor[f], frame.features.descriptor, candidates);
    if (nearest.best < 0 || nearest.best_distance > options.strict) continue;
    if (float(nearest.best_distance) > options.ratio_brute_force * float(nearest.second_distance))
      continue;
    table.offer({nearest.best, id, map.landmark(id).position, nearest.best_distance},
                keyframe.features.angle[f]);
  }
  return table.take_consistent(frame);
}

}  // namespace dkp_slam
