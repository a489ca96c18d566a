#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/masks/depth_view.h"
#include "dkp_slam/dynamics/masks/flat_patches.h"
#include "dkp_slam/dynamics/masks/object_mask.h"
#include "dkp_slam/dynamics/masks/plane.h"
#include "dkp_slam/dynamics/masks/segments.h"

namespace dkp_slam {

class OptionList;

/// How a box's depth becomes an object mask (paper §3.4, Algorithm 1).
enum class ClusteringMode {
  adaptive,  ///< K from the object's thickness, near clusters joined, planes removed (algorithm.md)
  paper,     ///< Eq. 1 to the letter: K = D_max / N in raw depth units and pixels, nearest cluster
  band,      ///< no clusters: everything within `band` of T, same clean-up. A cross-check
};

struct ClusteringOptions {
  ClusteringMode mode = ClusteringMode::adaptive;
  int min_clusters = 4;  ///< fewer merge a person with the wall behind
  int max_clusters = 8;  ///< more slice a person into layers thinner than an arm
  /// Clusters whose centres lie this near to the chosen one belong to it, metres: half the depth
  /// of a person with an arm stretched out.
  double join_distance = 0.30;
  double band = 0.33;               ///< metres to each side of T, mode `band`
  double raw_depth_scale = 5000.0;  ///< depth units per metre of Eq. 1, mode `paper`
  bool remove_planes = true;        ///< tables and floors run through the person's depth
  PlaneOptions planes;
  int opening = 1;               ///< radius of the opening, pixels of the view: speckles of depth
  double min_blob_share = 0.15;  ///< of the mask: an arm behind a lamp stays, a speckle goes
  /// How far the mask may grow out of a box that is too tight, share of the box's sides.
  double growth = 0.25;
  /// Smallest share of a box's central half that a depth mode needs to be taken for the object at
  /// first sight, mode `paper`: less is something thin in front of it.
  double first_mode_share = 0.2;
  SegmentOptions segments;
  FlatPatchOptions flat_patches;
  /// Share of a segment that must lie in the (grown) box to be taken for a part of the object:
  /// what runs on outside is the room or somebody else.
  double inside_share = 0.5;
  /// Crumbs at the outline, where a body turns away and its depth falls off in steps: surfaces of
  /// fewer pixels of the view, no more than `crumb_step` metres off the mask beside them, join it.
  int crumb_area = 60;
  double crumb_step = 0.06;
  int crumb_reach = 3;  ///< pixels of the view

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// What is known of an object from the frame before.
struct ObjectPrior {
  float mean_depth = 0.0F;  ///< T, metres; 0 at first sight
  float share = 0.0F;       ///< R; 0 at first sight
  ObjectMask mask;          ///< silhouette in the frame before; empty at first sight
  cv::Point shift;          ///< how far it moved since, pixels of the view
  bool carried = false;     ///< not detected now: found only where its silhouette went
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
