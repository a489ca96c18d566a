#include "dkp_slam/tracking/tracker.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <spdlog/spdlog.h>

#include "dkp_slam/localization/matcher.h"
#include "dkp_slam/localization/pose_refinement.h"
#include "dkp_slam/localization/relocalizer.h"

namespace dkp_slam {
namespace {

int static_with_depth(const Frame& frame) {
  int count = 0;
  for (std::size_t i = 0; i < frame.is_static.size(); ++i) {
    count += frame.is_static[i] && frame.features.depth[i] > 0.0F;
  }
  return count;
}

}  // namespace

Tracker::Tracker(Map& map, const PlaceIndex& places, const MeasurementModel& model,
                 const TrackerOptions& options, bool localize_only, std::uint64_t seed)
    : map_(map),
      places_(places),
      model_(model),
      options_(options),
      localize_only_(localize_only),
      seed_(seed) {
  // In a map from before the camera first has to find out where it is.
  if (map_.live_keyframes() > 0) state_ = TrackingState::lost;
}

TrackingResult Tracker::track(Frame& frame, bool adjusting) {
  follow_map_changes();
  frame.landmark.assign(static_cast<std::size_t>(frame.features.size()), -1);
  tracked_landmarks_ = 0;
  recognised_ = false;
  if (state_ == TrackingState::not_initialized) {
    return localize_only_ ? TrackingResult() : initialize(frame);
  }
  if (!localize(frame)) {
    if (shows_unmapped_room(frame)) return go_on_in_another_map(frame);
    if (state_ == TrackingState::tracking) spdlog::warn("frame {}: lost", frame.index);
    state_ = TrackingState::lost;
    motion_time_ = 0.0;
    return start_another_map(frame);
  }
  state_ = TrackingState::tracking;
  lost_since_.reset();
  if (tracked_landmarks_ > 0) map_time_ = frame.timestamp;
  led_from_map_ =
      tracked_landmarks_ >= options_.least_for_motion || (led_from_map_ && can_be_carried(frame));
  most_tracked_ = std::max(most_tracked_, tracked_landmarks_);
  assert(has_each_landmark_once(map_, frame));
  const bool due =
      tracked_landmarks_ > 0 ? keyframe_is_due(frame, adjusting) : goes_on_unmapped(frame);
  return {true, due};
}

TrackedPose Tracker::settle(const Frame& frame, bool became_keyframe) {
  if (became_keyframe) {
    keyframe_time_ = frame.timestamp;
    most_tracked_ = 0;
    if (tracked_landmarks_ == 0) {
      // The first of a map, or one that was carried: what it made is what is tracked.
      tracked_landmarks_ = frame.tracked_landmarks();
      map_time_ = frame.timestamp;
      led_from_map_ = true;
    }
  }
  const bool follows = last_.index >= 0 && last_.index == frame.index - 1;
  remember(frame);
  return {frame.timestamp,      frame.reference_keyframe,
          last_from_reference_, follows ? frame.current_from_previous : std::nullopt,
          tracked_landmarks_,   !recognised_};
}

bool Tracker::localize(Frame& frame) {
  frame.reference_keyframe = last_.reference_keyframe;
  bool found = false;
  if (state_ == TrackingState::tracking) {
    correct_shutter(frame, predicted_motion(frame));
    found = track_by_motion(frame) || track_reference_keyframe(frame);
    if (found) correct_shutter(frame, frame.camera_from_world * last_.camera_from_world.inverse());
    found = found && track_local_map(frame);
  }
  if (found && comes_after_gap(frame) && tracked_landmarks_ < options_.least_for_motion) {
    // So few agree by chance now and then: they have to do only where no other place is recognised.
    const int few = tracked_landmarks_;
    Frame elsewhere = frame;
    forget_place(elsewhere);
    if (recognise(elsewhere)) {
      frame = std::move(elsewhere);
      return true;
    }
    tracked_landmarks_ = few;
  }
  if (!found) {
    if (recognise(frame)) return true;
    follow_motion_since_last(frame);
    if (!find_near(frame, Trust::masks) && !carry_by_motion(frame) &&
        !find_near(frame, Trust::map)) {
      return false;
    }
  }
  if (begun_on_people(frame)) return false;
  // Only well-founded poses tell how the camera moves: a poor one would be carried on for frames.
  if (tracked_landmarks_ >= options_.least_for_motion) {
    motion_ = frame.camera_from_world * last_.camera_from_world.inverse();
    motion_time_ = frame.timestamp - last_.timestamp;
  }
  return true;
}

/// Finds the frame's place by its looks.
bool Tracker::recognise(Frame& frame) {
  if (!relocalize(map_, places_, model_, seed_, frame) || !track_local_map(frame)) return false;
  // The place may lie in another map, and the way there is no motion of the camera.
  const int here = map_.keyframe(frame.reference_keyframe).map;
  if (here != map_.current_map()) begun_ = long_ago;
  map_.set_current_map(here);
  motion_time_ = 0.0;
  recognised_ = true;
  return true;
}

/// Whether the map was out of sight before this frame, and nobody measured how the camera moved.
bool Tracker::comes_after_gap(const Frame& frame) const {
  return state_ == TrackingState::tracking && !frame.current_from_previous &&
         frame.timestamp - map_time_ >= options_.longest_steady;
}

void Tracker::forget_place(Frame& frame) const {
  frame.reference_keyframe = last_.reference_keyframe;
  std::fill(frame.landmark.begin(), frame.landmark.end(), -1);
}

/// Whether the second frame of a map lies farther from the first than a camera is carried.
bool Tracker::begun_on_people(const Frame& frame) const {
  if (map_time_ > begun_) return false;
  const Se3 step = frame.camera_from_world * last_.camera_from_world.inverse();
  return step.translation.norm() > options_.most_first_speed * (frame.timestamp - last_.timestamp);
}

/// Whether a frame whose motion is known shows enough to go on from, which the map does not know.
bool Tracker::shows_unmapped_room(const Frame& frame) const {
  return !localize_only_ && can_be_carried(frame) &&
         static_with_depth(frame) >= options_.least_to_go_on;
}

/// Not where a few landmarks alone, found by chance, lead from the map to here: what lies beyond is
/// another map until the two meet.
bool Tracker::goes_on_unmapped(const Frame& frame) const {
  return led_from_map_ && shows_unmapped_room(frame) &&
         frame.timestamp - map_time_ > options_.longest_unmapped;
}

TrackingResult Tracker::go_on_in_another_map(Frame& frame) {
  spdlog::warn("frame {}: the map was left {:.1f} s ago, another one is begun", frame.index,
               frame.timestamp - map_time_);
  frame.camera_from_world = predicted_motion(frame) * last_.camera_from_world;
  map_.start_map();
  return initialize(frame);
}

TrackingResult Tracker::start_another_map(Frame& frame) {
  if (!lost_since_) lost_since_ = frame.timestamp;
  const double lost = frame.timestamp - *lost_since_;
  const double wait = std::min(options_.longest_loss, 2.0 * (map_time_ - begun_));
  if (localize_only_ || lost < wait || !can_start(frame)) return {};
  spdlog::warn("frame {}: lost for {:.1f} s, another map is begun", frame.index, lost);
  lost_since_.reset();
  map_.start_map();
  // Its world is placed so that the camera is where it was last seen: a guess, until maps meet.
  frame.camera_from_world = last_.camera_from_world;
  return initialize(frame);
}

bool Tracker::can_start(const Frame& frame) const {
  return static_with_depth(frame) >= options_.least_to_start;
}

TrackingResult Tracker::initialize(const Frame& frame) {
  if (!can_start(frame)) return {};
  state_ = TrackingState::tracking;
  map_time_ = begun_ = frame.timestamp;
  return {true, true};
}

Se3 Tracker::motion_over(double seconds) const {
  if (motion_time_ <= 0.0) return {};
  return Se3::exp(seconds / motion_time_ * motion_.log());
}

Se3 Tracker::predicted_motion(const Frame& frame) const {
  const double passed = frame.timestamp - last_.timestamp;
  const Se3 steady = motion_over(passed);
  if (!frame.current_from_previous || last_.index != frame.index - 1) {
    return frame.timestamp - map_time_ < options_.longest_steady ? steady : Se3();
  }
  if (motion_time_ <= 0.0) return *frame.current_from_previous;
  // Nobody changes a camera's speed faster than that: else the flow was not that of the room.
  const Se3 change = *frame.current_from_previous * steady.inverse();
  const bool plausible = change.translation.norm() < options_.most_acceleration * passed * passed &&
                         change.angle() < options_.most_angular_acceleration * passed * passed;
  if (plausible) return *frame.current_from_previous;
  // A guess from old motion runs away; after a few frames even a doubtful measurement is better.
  return frame.timestamp - map_time_ < options_.longest_steady ? steady
                                                               : *frame.current_from_previous;
}

bool Tracker::track_by_motion(Frame& frame) {
  // Constant velocity, over the time that has really passed: frames may be missing.
  const double passed = frame.timestamp - last_.timestamp;
  const Se3 predicted = predicted_motion(frame) * last_.camera_from_world;
  int found = follow_landmarks(predicted, frame);
  constexpr double longest_gap = 0.5;  // seconds: a hand has turned back by then
  const bool gap = comes_after_gap(frame);
  const double longest = gap ? longest_gap : options_.longest_steady;
  if ((found > 0 || gap) && found < options_.sure_from_motion && motion_time_ > 0.0 &&
      frame.timestamp - map_time_ < longest) {
    // Where people fill the view the measured motion may be theirs, and over a gap nothing but the
    // last motion tells anything. Nearly as many landmarks found from elsewhere are no proof.
    constexpr double clearly_more = 1.5;
    const int least = gap ? options_.least_for_motion : 0;
    Frame other = frame;
    const int more = follow_landmarks(motion_over(passed) * last_.camera_from_world, other);
    if (more > clearly_more * found && more >= least) {
      frame = std::move(other);
      found = more;
    }
  }
  if (found > 0) return true;
  // A frame that was carried has no landmarks to follow, but its motion leads to those of the map
  // about it.
  frame.camera_from_world = predicted;
  return last_.tracked_landmarks() == 0 && frame.current_from_previous.has_value();
}

/// The pose by the last frame's landmarks, looked for about where `guess` has them. Returns how
/// many agree on it; 0 where they are too few.
int Tracker::follow_landmarks(const Se3& guess, Frame& frame) const {
  for (const float widen : {1.0F, 2.0F}) {
    frame.camera_from_world = guess;
    std::vector<FrameMatch> matches =
        match_last_frame(map_, last_, frame, widen * options_.motion_radius);
    if (static_cast<int>(matches.size()) < options_.least_from_motion) continue;
    const int agree = refine_pose(map_, model_, frame, matches);
    if (agree < options_.least_from_motion / 2) continue;
    assign_landmarks(matches, frame);
    return agree;
  }
  return 0;
}

void Tracker::correct_shutter(Frame& frame, const Se3& motion) const {
  const double passed = frame.timestamp - last_.timestamp;
  if (map_.camera().readout <= 0.0 || passed <= 0.0) return;
  Vector6d velocity = motion.log() / passed;
  // That is the velocity half a frame ago; at the frame's own moment it has changed on.
  if (motion_time_ > 0.0) velocity += 0.5 * (velocity - motion_.log() / motion_time_);
  frame.features.correct_rolling_shutter(map_.camera(), velocity);
}

void Tracker::follow_motion_since_last(const Frame& frame) {
  const bool lost = state_ == TrackingState::lost;
  const Se3 step = lost ? frame.current_from_previous.value_or(Se3()) : predicted_motion(frame);
  since_last_ = lost ? step * since_last_ : step;
}

bool Tracker::find_near(Frame& frame, Trust trust) {
  if (last_.index < 0 || frame.timestamp - map_time_ > options_.longest_carry) return false;
  const std::vector<char> is_static = frame.is_static;
  frame.camera_from_world = since_last_ * last_.camera_from_world;
  if (localize_near(map_, model_, seed_, last_.reference_keyframe, trust, frame) > 0 &&
      track_local_map(frame)) {
    return true;
  }
  forget_place(frame);
  frame.is_static = is_static;
  return false;
}

/// Without a measured motion a pose would be a guess, and a guess is no localisation.
bool Tracker::can_be_carried(const Frame& frame) const {
  return state_ == TrackingState::tracking && frame.current_from_previous &&
         last_.index == frame.index - 1;
}

bool Tracker::carry_by_motion(Frame& frame) {
  if (!can_be_carried(frame)) return false;
  if (frame.timestamp - map_time_ > options_.longest_carry) return false;
  frame.camera_from_world = predicted_motion(frame) * last_.camera_from_world;
  forget_place(frame);
  spdlog::debug("frame {}: carried by its motion, {} landmarks tracked", frame.index,
                tracked_landmarks_);
  tracked_landmarks_ = 0;
  return true;
}

bool Tracker::track_reference_keyframe(Frame& frame) {
  frame.camera_from_world = last_.camera_from_world;
  std::vector<FrameMatch> matches =
      match_keyframe(map_, map_.keyframe(frame.reference_keyframe), frame);
  if (matches.size() < 15) return false;
  if (refine_pose(map_, model_, frame, matches) < 10) return false;
  assign_landmarks(matches, frame);
  return true;
}

/// The reference keyframe does not tell: of a new one few landmarks were seen twice.
bool Tracker::view_is_left() const {
  return most_tracked_ >= options_.left_least &&
         tracked_landmarks_ < options_.left_share * most_tracked_;
}

bool Tracker::keyframe_is_due(const Frame& frame, bool adjusting) const {
  if (localize_only_) return false;
  const auto room = std::count(frame.is_static.begin(), frame.is_static.end(), 1);
  if (room < options_.least_keyframe_features) return false;
  if (!adjusting && frame.timestamp - keyframe_time_ >= options_.keyframe_interval) return true;
  const Keyframe& reference = map_.keyframe(frame.reference_keyframe);
  int reference_landmarks = 0;
  const std::size_t least_sightings = map_.live_keyframes_in(map_.current_map()) <= 2 ? 1 : 2;
  for (const int l : reference.landmarks) {
    reference_landmarks += l >= 0 && map_.landmark(l).sightings.size() >= least_sightings;
  }
  // Near features that no landmark claims, as ORB-SLAM2: few tracked and many to gain.
  int near_tracked = 0, near_free = 0;
  for (int i = 0; i < frame.features.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const float depth = frame.features.depth[s];
    if (!frame.is_static[s] || depth <= 0.0F || depth > 40.0 * map_.camera().baseline) continue;
    (frame.landmark[s] >= 0 ? near_tracked : near_free) += 1;
  }
  constexpr int few = 100, many = 70;
  const bool need_near = near_tracked < few && near_free > many;
  const double wanted = adjusting ? options_.urgent_share : options_.keyframe_share;
  if (tracked_landmarks_ < wanted * reference_landmarks) return true;
  // While the last one is still adjusted its landmarks have to do, but for a view that is left by
  // them within a few frames, as one that people hide.
  constexpr double rest = 0.1;  // seconds
  if (adjusting && frame.timestamp - keyframe_time_ < rest) return false;
  if (view_is_left()) return true;
  const bool sure = tracked_landmarks_ >= options_.least_for_motion;
  return need_near && (!adjusting || (sure && tracked_landmarks_ < few));
}

void Tracker::follow_map_changes() {
  if (last_.reference_keyframe < 0) return;
  last_.camera_from_world = last_from_reference_ * map_.keyframe_pose(last_.reference_keyframe);
  while (map_.keyframe(last_.reference_keyframe).removed) {
    last_.reference_keyframe = map_.keyframe(last_.reference_keyframe).parent;
  }
  last_from_reference_ =
      last_.camera_from_world * map_.keyframe_pose(last_.reference_keyframe).inverse();
  resolve_landmarks(map_, last_);
}

void Tracker::remember(const Frame& frame) {
  last_ = frame;
  last_from_reference_ =
      frame.camera_from_world * map_.keyframe_pose(frame.reference_keyframe).inverse();
}

}  // namespace dkp_slam
