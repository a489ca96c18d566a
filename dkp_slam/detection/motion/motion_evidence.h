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
  cv::Mat unseen;   ///< CV_8UC1: 255 where that place was outside the earlier frame or at its rim
  cv::Mat texture;  ///< CV_32FC1, grey levels per cell, of the current frame
  float threshold = 0.0F;  ///< cells by which flow had to miss the camera's own
};

/// Compares two frames some tenths of a second apart, given the camera's motion between them: a
/// cell moves when dense optical flow (DIS) disagrees with the flow that the camera's motion gives
/// a static point of its depth, and the images agree with the former.
class MotionEvidenceFinder {
 public:
  explicit MotionEvidenceFinder(const CoarseGrid& grid, const MotionEvidenceOptions& options = {});

  MotionEvidence find(const CoarseView& current, const CoarseView& earlier,
                      const Se3& earlier_from_current) const;
  /// Adds the votes for motion of a newer frame where `evidence` is of an earlier one that did not
  /// show the place: who steps in at the edge of a camera that turns towards him. (That something
  /// stands still takes longer to tell.)
  void add_newer(const CoarseView& current, const CoarseView& newer, const Se3& newer_from_current,
                 MotionEvidence& evidence) const;

 private:
  /// Where an earlier frame shows the cells of a part of the current one; all of the part's size.
  struct Followed {
    cv::Rect part;
    cv::Mat flow;       // CV_32FC2, cells
    cv::Mat by_flow;    // CV_32FC2, cells of the earlier frame
    cv::Mat by_camera;  // CV_32FC2, the same for a static point; as by flow where depth is unknown
    cv::Mat miss;       // CV_32FC1, cells between both, -1 where nothing can be compared
    cv::Mat came, unseen;  // as in `MotionEvidence`
  };
  Followed follow(const CoarseView& current, const CoarseView& earlier,
                  const Se3& earlier_from_current, const cv::Rect& part) const;
  float least_miss(const cv::Mat& miss, const cv::Mat& texture) const;
  cv::Mat votes(const CoarseView& current, const CoarseView& earlier, const Followed& followed,
                const cv::Mat& texture, float threshold) const;

  const CoarseGrid& grid_;
  MotionEvidenceOptions options_;
  cv::Rect inside_;  // of the grid, without the rim where flow tells nothing
  cv::Ptr<cv::DISOpticalFlow> flow_;
};

}  // namespace dkp_slam
