#include "dkp_slam/localization/relocalizer.h"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "dkp_slam/localization/alignment.h"
#include "dkp_slam/localization/matcher.h"
#include "dkp_slam/localization/pose_refinement.h"

namespace dkp_slam {
namespace {

constexpr std::size_t least_matches = 15;   // worth a RANSAC
constexpr int least_aligned = 10;           // matches that agree on a pose
constexpr int least_inliers = 30;           // after the guided search: a pose to trust
constexpr std::size_t most_candidates = 5;  // keyframes that get a RANSAC

/// A first pose from matches with many outliers, which are erased.
bool align(const Map& map, const MeasurementModel& model, std::uint64_t seed,
           std::vector<FrameMatch>& matches, Frame& frame) {
  const std::vector<PoseObservation> observations = observations_of(frame, matches, map, model);
  AlignmentOptions options;
  options.least_inliers = least_aligned;
  const auto alignment = align_camera(map.camera(), model, observations, options, seed);
  if (!alignment) return false;
  frame.camera_from_world = alignment->camera_from_world;
  std::vector<FrameMatch> kept;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (alignment->inlier[i]) kept.push_back(matches[i]);
  }
  matches = std::move(kept);
  return refine_pose(map, model, frame, matches) >= least_aligned;
}

bool lasts(const Landmark& landmark) {
  constexpr int lasting = 4;  // frames that have found it
  return landmark.found >= lasting;
}

/// Share of the map's landmarks that have been found for a while, from a thousand or two of them.
double lasting_share(const Map& map) {
  const std::vector<int> ids = map.landmarks();
  const std::size_t step = 1 + ids.size() / 2000;
  double lasting = 0.0, all = 0.0;
  for (std::size_t i = 0; i < ids.size(); i += step) {
    lasting += lasts(map.landmark(ids[i]));
    all += 1.0;
  }
  return all > 0.0 ? lasting / all : 0.0;
}

/// Whether enough of those that agree on a pose have been found for a while, as of the whole map.
/// Where people hide the room a pose that follows them finds many landmarks, made on whoever stood
/// still before the camera; but hardly one that has lasted.
bool rests_on_what_lasts(const Map& map, const std::vector<FrameMatch>& matches) {
  constexpr double least = 0.15;
  const auto found = std::count_if(matches.begin(), matches.end(), [&](const FrameMatch& m) {
    return lasts(map.landmark(m.landmark));
  });
  const double enough = least * static_cast<double>(matches.size());
  // Mostly there are enough for any map, which then need not be gone through.
  return static_cast<double>(found) >= enough ||
         static_cast<double>(found) >= enough * lasting_share(map);
}

/// Landmarks of the keyframes around one that the frame does not have yet.
std::vector<int> further_landmarks(const Map& map, int keyframe, const Frame& frame) {
  std::vector<int> ids = map.best_covisible(keyframe, 10);
  ids.push_back(keyframe);
  std::vector<int> known = frame.landmark, others;
  std::sort(known.begin(), known.end());
  for (const int l : map.landmarks_of(ids)) {
    if (!std::binary_search(known.begin(), known.end(), l)) others.push_back(l);
  }
  return others;
}

}  // namespace

std::vector<FrameMatch> align_to_keyframe(const Map& map, const MeasurementModel& model,
                                          std::uint64_t seed, int keyframe, Frame& frame) {
  std::vector<FrameMatch> matches = match_keyframe(map, map.keyframe(keyframe), frame);
  if (matches.size() < least_matches || !align(map, model, seed, matches, frame)) return {};
  return matches;
}

int localize_around(const Map& map, const MeasurementModel& model, int keyframe,
                    std::vector<FrameMatch> matches, Frame& frame) {
  assign_landmarks(matches, frame);
  const std::vector<int> others = further_landmarks(map, keyframe, frame);
  for (const FrameMatch& m :
       match_visible(map, frame, landmarks_in_view(map, frame, others), 3.0F)) {
    if (frame.is_static[static_cast<std::size_t>(m.feature)]) matches.push_back(m);
  }
  const int inliers = refine_pose(map, model, frame, matches);
  if (inliers < least_inliers || !rests_on_what_lasts(map, matches)) return 0;
  assign_landmarks(matches, frame);
  frame.reference_keyframe = keyframe;
  return inliers;
}

int localize_by_keyframe(const Map& map, const MeasurementModel& model, std::uint64_t seed,
                         int keyframe, Frame& frame) {
  std::vector<FrameMatch> matches = align_to_keyframe(map, model, seed, keyframe, frame);
  return matches.empty() ? 0 : localize_around(map, model, keyframe, std::move(matches), frame);
}

int localize_near(const Map& map, const MeasurementModel& model, std::uint64_t seed, int keyframe,
                  Trust trust, Frame& frame) {
  constexpr float wide = 12.0F;  // four times as far as where the pose is known
  std::fill(frame.landmark.begin(), frame.landmark.end(), -1);
  const std::vector<int> about = further_landmarks(map, keyframe, frame);
  std::vector<FrameMatch> matches =
      match_visible(map, frame, landmarks_in_view(map, frame, about), wide);
  if (trust == Trust::masks) {
    std::erase_if(matches, [&](const FrameMatch& m) {
      return !frame.is_static[static_cast<std::size_t>(m.feature)];
    });
  }
  if (matches.size() < least_matches || !align(map, model, seed, matches, frame)) return 0;
  if (trust == Trust::map) {
    if (matches.size() < static_cast<std::size_t>(least_inliers)) return 0;
    for (const FrameMatch& m : matches) frame.is_static[static_cast<std::size_t>(m.feature)] = 1;
  }
  return localize_around(map, model, keyframe, std::move(matches), frame);
}

bool relocalize(const Map& map, const PlaceIndex& places, const MeasurementModel& model,
                std::uint64_t seed, Frame& frame) {
  std::vector<Descriptor> descriptors;
  for (std::size_t i = 0; i < frame.features.descriptor.size(); ++i) {
    if (frame.is_static[i]) descriptors.push_back(frame.features.descriptor[i]);
  }
  std::fill(frame.landmark.begin(), frame.landmark.end(), -1);
  for (const PlaceCandidate& c : places.query(map, descriptors, most_candidates)) {
    if (const int landmarks = localize_by_keyframe(map, model, seed, c.keyframe, frame)) {
      spdlog::info("frame {}: relocalised in keyframe {} with {} landmarks", frame.index,
                   c.keyframe, landmarks);
      return true;
    }
    std::fill(frame.landmark.begin(), frame.landmark.end(), -1);
  }
  return false;
}

}  // namespace dkp_slam
