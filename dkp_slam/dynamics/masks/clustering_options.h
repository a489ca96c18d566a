#pragma once

#include "dkp_slam/dynamics/masks/flat_patches.h"
#include "dkp_slam/dynamics/masks/segments.h"
#include "dkp_slam/geometry/planes/plane.h"

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

}  // namespace dkp_slam
