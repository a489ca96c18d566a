#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dkp_slam/dynamics/masks/clustering.h"

namespace dkp_slam {

/// Cuts objects out of the depth (paper §3.4), in the way that its options choose.
class MaskCutter {
 public:
  /// `focal_length` of the image in pixels.
  MaskCutter(const ClusteringOptions& options, double focal_length)
      : options_(options), focal_length_(focal_length) {}
  std::string name() const;

  /// The surroundings, once a frame; `planes` are the static ones, camera frame.
  Scene scene(const DepthView& view, const std::vector<Plane>& planes, std::uint64_t seed) const {
    return make_scene(view, focal_length_, planes, options_, seed);
  }
  /// Mask of the object in `box` (pixels of the image); empty when there is none.
  ObjectMask cut(const Scene& scene, const cv::Rect2f& box, const ObjectPrior& prior,
                 std::uint64_t seed) const {
    return cluster_object(scene, box, prior, options_, seed);
  }

 private:
  ClusteringOptions options_;
  double focal_length_;
};

}  // namespace dkp_slam
