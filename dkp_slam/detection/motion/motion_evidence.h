#pragma once

#include <opencv2/core.hpp>

#include "dkp_slam/detection/motion/coarse_grid.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"

// Named only, so that who includes this needs no headers of optical flow.
namespace cv {
class DISOpticalFlow;
}

namespace dkp_slam {

class OptionList;

struct MotionEvidenceOptions {
  /// Cells by which flow must miss the camera's own flow to count as motion: a constant (dense flow
  /// at grid resolution is good to about a quarter of a cell), or this many times the median
  /// of the image, whichever is more.
  float min_residual = 0.5F;
  float residual_medians = 3.0F;
  /// Grey values per cell, root mean square over 5 x 5 cells, below which flow tells nothing.
  float min_texture = 5.0F;
  /// Grey values, mean over 3 x 3 cells, by which the static prediction must look worse than the
  /// flow before a cell counts as moving.
  float min_contrast = 4.0F;
  float depth_tolerance = 0.06F;  ///< share of the depth, for "in front of" and "behind"

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// What an earlier frame says about each cell of the current one.
struct MotionEvidence {
  cv::Mat flow;  ///< CV_32FC2, cells: where the current cell was in the earlier frame, by flow
  cv::Mat vote;  ///< CV_8SC1: 1 moves, -1 stands still, 0 cannot be told
  cv::Mat came;  ///< CV_8UC1: 255 where the earlier frame saw through the place of the cell's point
};

/// Compares two frames some tenths of a second apart, given the camera's motion between them: a
/// cell moves when dense optical flow (DIS) disagrees with the flow that the camera's motion gives
/// a static point of its depth, and the images agree with the former.
class MotionEvidenceFinder {
 public:
  explicit MotionEvidenceFinder(const CoarseGrid& grid, const MotionEvidenceOptions& options = {});

  MotionEvidence find(const CoarseView& current, const CoarseView& earlier,
                      const Se3& earlier_from_current);

 private:
  const CoarseGrid& grid_;
  MotionEvidenceOptions options_;
  cv::Ptr<cv::DISOpticalFlow> flow_;
};

}  // namespace dkp_slam
