#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/detection/motion/coarse_grid.h"

namespace dkp_slam {

class OptionList;

struct MotionRegionOptions {
  float seed = 2.0F;    ///< log-odds of motion from which a cell starts a region
  float grow = -1.0F;   ///< log-odds above which a cell may join a neighbour's region
  float reach = 0.30F;  ///< metres along the surface that a region grows from its seeds
  /// Metres that a step in depth costs beyond its length, per metre: people stand upright, desks
  /// and floors run away from the camera.
  float depth_cost = 2.0F;
  /// Depth step between neighbouring cells that belong together, a constant (metres) and a share of
  /// the depth.
  float step = 0.02F;
  float step_share = 0.015F;
  /// Smaller regions, as a share of the image, are dropped: noise at edges comes in such sizes.
  double min_share = 0.004;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Grows what moves to depth-connected regions: from cells with log-odds of at least the seed over
/// neighbours of like depth, up to a distance along the surface. `log_odds` and `depth` are
/// CV_32FC1 of one size. Returns CV_8UC1, 255 on regions of at least the least share.
cv::Mat grow_motion(const cv::Mat& log_odds, const cv::Mat& depth, const CoarseGrid& grid,
                    const MotionRegionOptions& options);

/// One detection with a mask in pixels of the image for each connected region of `mask`. Scores
/// are the mean probability of motion over a region's seeds.
std::vector<Detection> motion_detections(const cv::Mat& mask, const cv::Mat& log_odds,
                                         const CoarseGrid& grid, const cv::Size& image_size,
                                         const MotionRegionOptions& options);

}  // namespace dkp_slam
