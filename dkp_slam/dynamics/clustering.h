#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/depth_view.h"
#include "dkp_slam/dynamics/frame_dynamics.h"
#include "dkp_slam/dynamics/plane.h"

namespace dkp_slam {

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
  double band = 0.33;           ///< metres to each side of T, mode `band`
  double raw_depth_scale = 5000.0;  ///< depth units per metre of Eq. 1, mode `paper`
  bool remove_planes = true;    ///< tables and floors run through the person's depth
  PlaneOptions planes;
  int opening = 1;              ///< radius of the opening, pixels of the view: speckles of depth
  double min_blob_share = 0.15;  ///< of the mask: an arm behind a lamp stays, a speckle goes
  /// How far the mask may grow out of a box that is too tight, share of the box's sides.
  double growth = 0.25;
  /// Depth step between neighbouring pixels that still belong to one surface: constant (metres)
  /// and share of the depth.
  double step_constant = 0.01;
  double step_share = 0.015;
  /// Smallest share of a box's central half a depth mode needs to be taken for the object when
  /// nothing is known of it yet: less is something thin in front of it.
  double first_mode_share = 0.2;
};

/// Silhouette of one object in pixels of the view.
struct ObjectMask {
  cv::Rect area;            ///< pixels of the view
  cv::Mat mask;             ///< CV_8UC1, size of `area`, 255 on the object
  float mean_depth = 0.0F;  ///< T, metres; 0 when the mask is empty
  float share = 0.0F;       ///< R: mask pixels over the box's pixels with a known depth
  int clusters = 0;         ///< K that was used
  bool empty() const { return mean_depth <= 0.0F; }
};

/// What is known of an object from the frame before.
struct ObjectPrior {
  float mean_depth = 0.0F;  ///< T, metres; 0 at first sight
  float share = 0.0F;       ///< R; 0 at first sight
};

/// Cuts the object in `box` (pixels of the image) out of the depth. `planes` is CV_8UC1 of the
/// view's size, 255 on the room's planes; empty for none.
ObjectMask cluster_object(const DepthView& view, const cv::Mat& planes, const cv::Rect2f& box,
                          const ObjectPrior& prior, const ClusteringOptions& options,
                          std::uint64_t seed);

/// Writes `label` where the object is into `labels` (CV_8UC1, image size).
void paint_object(const ObjectMask& object, std::uint8_t label, cv::Mat& labels);

/// Box in pixels of the view, clipped to it, for one in pixels of the image.
cv::Rect view_rect(const cv::Rect2f& box, const cv::Size& view_size);

}  // namespace dkp_slam
