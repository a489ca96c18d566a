#pragma once

#include <optional>
#include <vector>

#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/localization/frame.h"
#include "dkp_slam/map/map.h"
#include "dkp_slam/sensor/rgbd_frame.h"

namespace dkp_slam {

/// The first keyframe of a map is made of a frame of which nobody knows how fast the camera moved:
/// neither its rolling shutter nor the moment of its depth can be corrected. At 2 rad/s, as a hand
/// turns a camera, that bends the map's first view by 10 px from the middle to the edge, and bundle
/// adjustment holds it fixed. With the next frame the motion is known, where it is measured by flow
/// (a pose found in the bent view would bend with it), and the view is made anew.
class StartKeyframe {
 public:
  explicit StartKeyframe(Map& map) : map_(map) {}

  /// `frame` became the first keyframe of a map, of these features and this image.
  void remember(const Frame& frame, const OrbFeatures& orb, const RgbdFrame& image);
  /// Whether `frame` comes right after it, and so can tell how the camera moved.
  bool waits_for(const Frame& frame) const;
  /// Corrects the keyframe's features and the landmarks that it made; at once, before anything else
  /// in the map rests on them. `next_from_start`: the camera's motion to the frame that it waits
  /// for.
  void correct(const Frame& next, const Se3& next_from_start);

 private:
  struct Start {
    Frame frame;
    OrbFeatures orb;
    cv::Mat depth;             // CV_32FC1, metres
    double depth_delay = 0.0;  // seconds
  };

  Map& map_;
  std::optional<Start> start_;
};

}  // namespace dkp_slam
