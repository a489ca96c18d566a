#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/synth/tracing/embree_scene.h"
#include "dkp_slam/synth/tracing/shutter.h"

namespace dkp_slam {

/// Which pixels actors can be seen in during a frame, a little more than less: rays through all
/// others need not look for them.
class ActorReach {
 public:
  ActorReach(const EmbreeScene& scene, const Camera& camera, const Shutter& shutter);
  bool touches(const cv::Rect& pixels) const;

 private:
  std::vector<cv::Rect> actors_;
};

}  // namespace dkp_slam
