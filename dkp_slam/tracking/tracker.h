#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/localization/matcher.h"
#include "dkp_slam/localization/place_index.h"
#include "dkp_slam/localization/relocalizer.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/optimization/observation.h"

namespace dkp_slam {

class OptionList;

enum class TrackingState {
  not_initialized,  ///< waits for a first frame with enough static features with depth
  tracking,
  lost,  ///< the last frame was not localised; relocalisation is tried on each frame
};

struct TrackerOptions {
  int least_to_start = 100;    ///< static features with depth for the first keyframe
  int least_from_motion = 20;  ///< matches by the motion model before the window is doubled
  /// With fewer landmarks found where the measured motion has them, constant velocity is tried,
  /// too.
  int sure_from_motion = 100;
  int least_inliers = 20;       ///< landmarks tracked, below it the frame is lost
  float motion_radius = 12.0F;  ///< pixels on level 0, search window about the predicted place
  int local_keyframes = 40;     ///< that make the local map
  /// Static features that a keyframe needs: one taken while somebody fills the view adds little and
  /// is held so loosely that bundle adjustment may throw it a metre off.
  int least_keyframe_features = 150;
  /// A keyframe is due after this time at the latest...
  double keyframe_interval = 1.0;
  /// ... and as soon as fewer than this share of the reference keyframe's landmarks are tracked.
  double keyframe_share = 0.75;
  /// Under this share it does not wait for the bundle adjustment under way.
  double urgent_share = 0.5;
  /// So is one where fewer than this share of the most landmarks that were tracked since the last
  /// keyframe are: the camera has turned away from what the map knows, and a gap or a blurred frame
  /// would find nothing there...
  double left_share = 0.75;
  /// ... if those were so many. With fewer, keyframe hangs on keyframe by too little, and each more
  /// is more drift.
  int left_least = 200;
  /// A frame in which too few landmarks are found is placed by its measured motion from the frame
  /// before, if that was this long ago at most since the map was last seen, seconds: the time that
  /// somebody takes to walk past the camera. Beyond, drift would pass for localisation.
  double longest_carry = 1.0;
  /// Where so many static features with depth are in view that the map does not know, and the
  /// camera has been carried so long, seconds, the map goes on there: a keyframe is made where the
  /// motion has it, if that was measured all the way from a frame that tracked `least_for_motion`
  /// landmarks. Beyond `longest_carry` it is another map that goes on.
  int least_to_go_on = 300;
  double longest_unmapped = 0.3;
  /// Constant velocity is assumed no longer than this since the map was last seen, seconds; over a
  /// longer gap it is tried beside standing still.
  double longest_steady = 0.15;
  /// Another map is begun when no frame has been localised for this long, seconds, or for twice as
  /// long as the map was followed: one of a moment is not worth waiting for. Sooner, and a hand
  /// over the lens would leave pieces behind; later, and what lies between is never mapped.
  double longest_loss = 1.0;
  /// Speed, m/s, by which the second frame of a map may lie from its first. Nobody carries a camera
  /// faster: where it seems so, the map was begun on people, and another one is begun.
  double most_first_speed = 4.0;
  /// Landmarks tracked in a frame whose motion is believed; with fewer, its place after a gap is
  /// doubted.
  int least_for_motion = 40;
  /// Bounds for a measured motion to be believed against constant velocity, m/s^2 and rad/s^2: a
  /// hand-held camera that is shaken stays under 20 and 60.
  double most_acceleration = 20.0;
  double most_angular_acceleration = 60.0;
  /// Landmarks keep a belief about being dynamic: trusted ones are tracked on features that were
  /// called dynamic, and those that stray are removed. Without it what was called dynamic is not
  /// used, and nothing is remembered of it.
  bool use_belief = true;
  /// Whether the pose follows the room's landmarks alone where near and far ones put the camera
  /// elsewhere (`matches_on_room`).
  bool find_room = true;
  LandmarkBelief belief;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// The pose a frame was given when it was tracked, kept relative to its reference keyframe, so that
/// what adjusts the keyframe later adjusts the frame too.
struct TrackedPose {
  double timestamp = 0.0;
  int reference_keyframe = -1;
  Se3 camera_from_reference;
  /// This camera from the camera at the pose before, by flow; nothing where that frame was not
  /// localised or the motion was not measured.
  std::optional<Se3> from_previous;
  int landmarks = 0;  ///< that the pose rests on
  /// The camera moved here from the pose before: not where its place was recognised.
  bool continues = true;
};

/// What tracking a frame came to.
struct TrackingResult {
  bool localised = false;
  bool keyframe_due = false;  ///< the frame should become a keyframe, before `settle`
};

/// Localises frame after frame in the map and says which should become keyframes (ORB-SLAM's
/// tracking thread, Mur-Artal et al. 2015, §V, for RGB-D).
///
/// Two calls a frame: `track`, and `settle` once what it asked for has been done.
class Tracker {
 public:
  /// `localize_only`: find the camera in the map that is there, and change nothing in it. `seed`
  /// is of relocalisation's RANSAC.
  Tracker(Map& map, const PlaceIndex& places, const MeasurementModel& model,
          const TrackerOptions& options, bool localize_only = false, std::uint64_t seed = 1);

  /// Localises the frame: sets its pose, reference keyframe and landmarks, each of which is in the
  /// map and belongs to one feature only. `adjusting`: a local bundle adjustment is under way, for
  /// which keyframes that are not urgent wait.
  TrackingResult track(Frame& frame, bool adjusting);
  /// Takes a frame that was localised as the one to track the next from. `became_keyframe`: it was
  /// inserted into the map and is its own reference keyframe now. Returns its pose for those who
  /// keep the path.
  TrackedPose settle(const Frame& frame, bool became_keyframe);

  /// Camera at `seconds` after the last frame from camera at the last frame, were it to move on as
  /// it did; identity while its motion is unknown.
  Se3 motion_over(double seconds) const;

  TrackingState state() const { return state_; }
  int tracked_landmarks() const { return tracked_landmarks_; }

 private:
  bool can_start(const Frame& frame) const;
  TrackingResult initialize(const Frame& frame);
  bool localize(Frame& frame);
  bool recognise(Frame& frame);
  bool comes_after_gap(const Frame& frame) const;
  void forget_place(Frame& frame) const;
  bool begun_on_people(const Frame& frame) const;
  bool shows_unmapped_room(const Frame& frame) const;
  bool goes_on_unmapped(const Frame& frame) const;
  TrackingResult go_on_in_another_map(Frame& frame);
  TrackingResult start_another_map(Frame& frame);
  bool track_by_motion(Frame& frame);
  int follow_landmarks(const Se3& guess, Frame& frame) const;
  bool track_reference_keyframe(Frame& frame);
  bool track_local_map(Frame& frame);
  std::vector<int> local_landmarks(Frame& frame) const;
  void follow_room(const std::vector<FrameMatch>& offered, Frame& frame,
                   std::vector<FrameMatch>& matches);
  void drop_dynamic(const Frame& frame, std::vector<FrameMatch>& matches) const;
  void weigh_evidence(Frame& frame, const std::vector<FrameMatch>& matches);
  void follow_motion_since_last(const Frame& frame);
  /// Near where the map was last seen, by the motions that were measured since; with `Trust::map`
  /// also by features that masks hide: a mask may be wrong.
  bool find_near(Frame& frame, Trust trust);
  bool can_be_carried(const Frame& frame) const;
  bool carry_by_motion(Frame& frame);
  Se3 predicted_motion(const Frame& frame) const;
  bool view_is_left() const;
  bool keyframe_is_due(const Frame& frame, bool adjusting) const;
  void correct_shutter(Frame& frame, const Se3& motion) const;
  void follow_map_changes();
  void remember(const Frame& frame);

  static constexpr double long_ago = std::numeric_limits<double>::lowest();

  Map& map_;
  const PlaceIndex& places_;
  const MeasurementModel model_;
  const TrackerOptions options_;
  const bool localize_only_;
  const std::uint64_t seed_;
  TrackingState state_ = TrackingState::not_initialized;
  Frame last_;
  Se3 last_from_reference_;
  Se3 motion_;                ///< camera at the last frame from camera at the one before
  double motion_time_ = 0.0;  ///< seconds that motion took; 0 when unknown
  double keyframe_time_ = 0.0;
  Se3 since_last_;         ///< the camera's motion since `last_`, as far as it was measured
  double map_time_ = 0.0;  ///< of the last frame that the map placed, or that it went on with
  /// Every motion since a frame that the map surely placed was measured.
  bool led_from_map_ = false;
  double begun_ = long_ago;           ///< of the first frame in the map, where the tracker began it
  std::optional<double> lost_since_;  ///< timestamp of the first frame that was not localised
  bool recognised_ = false;           ///< the frame's place was found by its looks
  int tracked_landmarks_ = 0;
  int most_tracked_ = 0;  ///< landmarks, in a frame since the last keyframe
};

}  // namespace dkp_slam
