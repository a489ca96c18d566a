#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "dkp_slam/localization/depth_groups.h"
#include "dkp_slam/localization/matcher.h"
#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/map/id_map.h"
#include "dkp_slam/tracking/tracker.h"

namespace dkp_slam {

std::vector<int> Tracker::local_landmarks(Frame& frame) const {
  IdMap<int> votes;
  std::vector<int> keyframes;
  const auto vote = [&](int k) {
    if (votes.insert(k).first++ == 0) keyframes.push_back(k);
  };
  for (const int l : frame.landmark) {
    if (l < 0) continue;
    for (const Sighting& s : map_.landmark(l).sightings) vote(s.keyframe);
  }
  if (keyframes.empty()) vote(frame.reference_keyframe);
  std::sort(keyframes.begin(), keyframes.end(), [&](int a, int b) {
    const int votes_a = *votes.find(a), votes_b = *votes.find(b);
    return votes_a != votes_b ? votes_a > votes_b : a < b;
  });
  frame.reference_keyframe = keyframes.front();
  for (std::size_t i = 0, direct = keyframes.size(); i < direct; ++i) {
    if (static_cast<int>(keyframes.size()) >= options_.local_keyframes) break;
    for (const int n : map_.best_covisible(keyframes[i], 10)) {
      if (std::find(keyframes.begin(), keyframes.end(), n) != keyframes.end()) continue;
      keyframes.push_back(n);
      break;
    }
  }
  if (static_cast<int>(keyframes.size()) > options_.local_keyframes) {
    keyframes.resize(static_cast<std::size_t>(options_.local_keyframes));
  }

  return map_.landmarks_of(keyframes);
}

bool Tracker::track_local_map(Frame& frame) {
  std::vector<int> landmarks = local_landmarks(frame);
  std::vector<FrameMatch> matches;
  for (int i = 0; i < frame.features.size(); ++i) {
    const int l = frame.landmark[static_cast<std::size_t>(i)];
    if (l >= 0) matches.push_back({i, l, map_.landmark(l).position, 0});
  }
  std::vector<int> matched;
  for (const FrameMatch& m : matches) matched.push_back(m.landmark);
  std::sort(matched.begin(), matched.end());
  std::erase_if(landmarks,
                [&](int l) { return std::binary_search(matched.begin(), matched.end(), l); });

  const std::vector<VisibleLandmark> visible = landmarks_in_view(map_, frame, landmarks);
  if (!localize_only_) {
    for (const VisibleLandmark& v : visible) ++map_.landmark(v.landmark).visible;
    for (const int l : matched) ++map_.landmark(l).visible;
  }
  constexpr float radius_factor = 3.0F;  // ORB-SLAM's for RGB-D
  for (const FrameMatch& m : match_visible(map_, frame, visible, radius_factor))
    matches.push_back(m);
  const std::vector<FrameMatch> all_matches = matches;
  drop_dynamic(frame, matches);
  const std::vector<FrameMatch> offered = matches;
  tracked_landmarks_ = refine_pose(map_, model_, frame, matches);
  if (options_.find_room) follow_room(offered, frame, matches);
  if (tracked_landmarks_ < options_.least_inliers) return false;
  assign_landmarks(matches, frame);
  if (localize_only_) return true;
  for (const FrameMatch& m : matches) ++map_.landmark(m.landmark).found;
  if (options_.use_belief) weigh_evidence(frame, all_matches);
  return true;
}

void Tracker::follow_room(const std::vector<FrameMatch>& offered, Frame& frame,
                          std::vector<FrameMatch>& matches) {
  std::vector<FrameMatch> on_room = matches_on_room(map_, model_, frame, offered);
  if (on_room.empty()) return;
  spdlog::debug("frame {}: near and far do not agree, {} of {} landmarks are the room's",
                frame.index, on_room.size(), offered.size());
  matches = std::move(on_room);
  tracked_landmarks_ = refine_pose(map_, model_, frame, matches);
}

void Tracker::drop_dynamic(const Frame& frame, std::vector<FrameMatch>& matches) const {
  std::erase_if(matches, [&](const FrameMatch& m) {
    const bool trusted = options_.use_belief && map_.landmark(m.landmark).dynamic_log_odds <=
                                                    options_.belief.trusted_below;
    return !frame.is_static[static_cast<std::size_t>(m.feature)] && !trusted;
  });
}

void Tracker::weigh_evidence(Frame& frame, const std::vector<FrameMatch>& matches) {
  const LandmarkBelief& belief = options_.belief;
  for (const FrameMatch& m : matches) {
    assert(map_.has_landmark(m.landmark));  // each is matched once, see resolve_landmarks
    Landmark& l = map_.landmark(m.landmark);
    const Observation seen = observation_of(frame.features, m.feature, map_, model_);
    const Eigen::Vector3d p = frame.camera_from_world * l.position;
    const bool in_place =
        p.z() > 0.0 && (map_.camera().project(p) - seen.pixel).squaredNorm() <=
                           model_.pixel_chi2 * seen.pixel_sigma * seen.pixel_sigma;
    const bool called_static = frame.is_static[static_cast<std::size_t>(m.feature)];
    const float change = in_place ? (called_static ? belief.stayed : belief.doubted)
                                  : (called_static ? belief.strayed : belief.moved);
    l.dynamic_log_odds = std::clamp(l.dynamic_log_odds + change, belief.lowest, belief.highest);
    if (l.dynamic_log_odds <= belief.dynamic_above) continue;
    map_.remove_landmark(m.landmark);
    frame.landmark[static_cast<std::size_t>(m.feature)] = -1;
  }
}

}  // namespace dkp_slam
