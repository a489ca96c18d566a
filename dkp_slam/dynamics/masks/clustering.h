#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/masks/clustering_options.h"
#include "dkp_slam/dynamics/masks/object_mask.h"
#include "dkp_slam/dynamics/masks/segments.h"
#include "dkp_slam/geometry/planes/depth_view.h"
#include "dkp_slam/geometry/planes/plane.h"

namespace dkp_slam {

/// What is known of an object from the frame before.
struct ObjectPrior {
  float mean_depth = 0.0F;  ///< T, metres; 0 at first sight
  float share = 0.0F;       ///< R; 0 at first sight
  ObjectMask mask;          ///< silhouette in the frame before; empty at first sight
  cv::Point shift;          ///< how far it moved since, pixels of the view
  /// A network gave the box, which is one person's; what merely moves may be several.
  bool named = false;
  bool carried = false;  ///< not detected now: found only where its silhouette went
};

/// Surroundings in which objects are cut out, the same for all boxes of a frame.
struct Scene {
  DepthView view;
  cv::Mat planes;       ///< CV_8UC1, view size, 255 on the room's planes; empty for none
  SegmentMap surfaces;  ///< of what lies off the planes
};

/// Builds the scene; `planes` are those of the room. `focal_length` of the image in pixels.
Scene make_scene(const DepthView& view, double focal_length, const std::vector<Plane>& planes,
                 const ClusteringOptions& options, std::uint64_t seed);

/// Cuts the object in `box` (pixels of the image) out of the depth. Adaptive K-means++ gives the
/// interval of depth; of the surfaces in it those are kept that lie in the box, large enough, and
/// are not proved to stand still while the object's main surface is another.
ObjectMask cluster_object(const Scene& scene, const cv::Rect2f& box, const ObjectPrior& prior,
                          const ClusteringOptions& options, std::uint64_t seed);

}  // namespace dkp_slam
