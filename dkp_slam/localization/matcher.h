#pragma once

#include <vector>

#include "dkp_slam/localization/frame.h"
#include "dkp_slam/map/map.h"

namespace dkp_slam {

class OptionList;

/// Descriptor distances, of 256 bits, as in ORB-SLAM.
struct MatchOptions {
  int loose = 100;                ///< where geometry already says where to look
  int strict = 50;                ///< where it does not
  float ratio_projection = 0.8F;  ///< best to second best, on the same level
  float ratio_brute_force = 0.75F;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// A feature of the current frame and what it shows.
struct FrameMatch {
  int feature = -1;
  int landmark = -1;         ///< -1 for a temporary point of the last frame
  Eigen::Vector3d position;  ///< world frame, metres
  int distance = 0;          ///< of the descriptors
};

/// Gives the frame's features the landmarks of the matches, and no others.
void assign_landmarks(const std::vector<FrameMatch>& matches, Frame& frame);

/// Follows what became of the frame's landmarks in the map since they were found: those fused into
/// another have that one's id, removed ones none. Where two features have come to one landmark the
/// first keeps it, so that a landmark belongs to one feature of a frame at most.
void resolve_landmarks(const Map& map, Frame& frame);

/// Whether every landmark of the frame is in the map and belongs to one feature only: what holds
/// whenever a frame has been tracked.
bool has_each_landmark_once(const Map& map, const Frame& frame);

/// Matches the last frame's landmarks (resolved, see above), and its points with depth that are no
/// landmarks yet, to the current frame, where they should appear under `frame.camera_from_world`;
/// `radius` is in pixels on level 0. Matches that turn against the majority's rotation are dropped.
std::vector<FrameMatch> match_last_frame(const Map& map, const Frame& last, const Frame& frame,
                                         float radius, const MatchOptions& options = {});

/// A landmark of the local map in the current view.
struct VisibleLandmark {
  int landmark = -1;
  Eigen::Vector2d pixel;
  int level = 0;
  double depth = 0.0;  ///< metres along z
  double view_cosine = 1.0;
};

/// The landmarks that should be visible from the frame's pose: in the image, in the range of
/// scales, seen from within 60 degrees of the mean direction.
std::vector<VisibleLandmark> landmarks_in_view(const Map& map, const Frame& frame,
                                               const std::vector<int>& landmarks);

/// Matches visible landmarks to features, both static and dynamic ones; features with a landmark
/// already are left alone. `radius_factor` widens the search window.
std::vector<FrameMatch> match_visible(const Map& map, const Frame& frame,
                                      const std::vector<VisibleLandmark>& visible,
                                      float radius_factor, const MatchOptions& options = {});

/// Matches by descriptor alone, between a keyframe's landmarks and the frame's static features.
std::vector<FrameMatch> match_keyframe(const Map& map, const Keyframe& keyframe, const Frame& frame,
                                       const MatchOptions& options = {});

}  // namespace dkp_slam
