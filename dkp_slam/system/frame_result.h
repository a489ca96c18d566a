#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/dynamics/frame_dynamics.h"
#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/sensor/rgbd_frame.h"
#include "dkp_slam/tracking/tracker.h"

namespace dkp_slam {

/// How far a frame's pose can be trusted, for whoever steers by it (docs/reliability.md).
struct PoseQuality {
  /// Of the camera's position (first three, square metres) and orientation (last three, square
  /// radians) along the camera's axes, relative to the room about it as the map has it: the true
  /// world_from_camera is that of the result times exp(xi). Infinite where not localised.
  Matrix6d covariance = unknown();
  /// Share of the image that lies on what may move: people and what they carry; 0 to 1.
  double people_share = 0.0;
  /// Seconds since a frame was placed by landmarks of the map: 0 where this one was, infinite where
  /// none ever was. A frame that is localised without (by its measured motion) is drifting.
  double since_map_seen = std::numeric_limits<double>::infinity();

  /// Standard deviation of the position in its worst direction, metres.
  double position_sigma() const;
  static Matrix6d unknown();
};

/// What became of one frame.
struct FrameResult {
  int index = 0;
  double timestamp = 0.0;                                ///< seconds, the frame's own
  TrackingState state = TrackingState::not_initialized;  ///< after the frame
  bool localised = false;
  /// Where the camera is, in the world frame of `map`, as known at that moment: later adjustments
  /// move it, see Slam::trajectory. Only where `localised`.
  Se3 world_from_camera;
  int map = 0;  ///< which of the atlas' maps
  /// The same relative to the keyframe that it was found by, -1 where not localised: with that
  /// one's pose as it is known later (MapChange) it follows loops and adjustments.
  int reference_keyframe = -1;
  Se3 camera_from_reference;
  int features = 0;
  int removed_features = 0;   ///< called dynamic
  int tracked_landmarks = 0;  ///< inliers that the pose rests on; 0 where motion carried it
  PoseQuality quality;
  int detections = 0;   ///< in this frame, scores high enough to start an object
  int compensated = 0;  ///< objects carried without a detection
  bool keyframe = false;
  int map_keyframes = 0, map_landmarks = 0;  ///< in all maps, after the frame
  double decode_ms = 0.0;                    ///< RgbdFrame::decode_ms
  /// In threads ahead of the tracker; `detection_ms` is 0 where the detector did not look.
  double feature_ms = 0.0, detection_ms = 0.0;
  double clustering_ms = 0.0, removal_ms = 0.0, tracking_ms = 0.0;
  double frame_ms = 0.0;    ///< from the last frame's end to this one's, all threads working
  double latency_ms = 0.0;  ///< from `feed` to this result
};

/// A frame with everything that was found out about it, as values that any thread may read.
struct FrameSnapshot {
  FrameResult result;
  RgbdFrame frame;
  std::vector<cv::KeyPoint> keypoints;  ///< raw (distorted) pixels
  std::vector<int> landmarks;           ///< per keypoint: id in the map, -1 for none
  DetectionResult detections;           ///< what the detector said by then
  FrameDynamics dynamics;               ///< objects, masks, verdict on each keypoint
};

}  // namespace dkp_slam
