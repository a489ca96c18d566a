#pragma once

#include <deque>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/detection/motion/background_model.h"
#include "dkp_slam/detection/motion/coarse_grid.h"
#include "dkp_slam/detection/motion/ego_motion.h"
#include "dkp_slam/detection/motion/motion_evidence.h"
#include "dkp_slam/detection/motion/motion_regions.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/planes/plane.h"
#include "dkp_slam/geometry/planes/static_planes.h"

namespace dkp_slam {

class OptionList;

struct MotionDetectorOptions {
  /// Cells in a row. 160: people at 5 m are still 15 cells wide, and a frame takes a few ms.
  int columns = 160;
  /// Seconds between the frames whose flow is compared: at 30 Hz a slow walk moves a person by a
  /// cell or more in this time, from one frame to the next it moves by the flow's own noise.
  double flow_interval = 0.12;
  /// Seconds after which evidence of motion that is not renewed has faded to 1/e: people pause.
  double memory = 1.0;
  /// Seconds after which something that came and stands still belongs to the background.
  double absorb_after = 2.0;
  /// Frames after which a cell of the background counts in full for the camera's motion.
  float known_age = 10.0F;
  double max_gap = 0.5;  ///< seconds between frames after which everything starts anew
  /// Log-odds of motion that one frame adds or takes, at 30 Hz.
  float came_gain = 1.0F;    ///< the point is where free space was seen
  float moving_gain = 1.6F;  ///< flow disagrees with the camera's motion
  float static_gain = 0.4F;  ///< flow agrees with it, in texture
  float same_gain = 0.1F;    ///< depth alone agrees
  /// Share of the depth by which a cell may differ from the one that its evidence comes from.
  float carry_step = 0.04F;
  /// The same where nobody knows how the camera moved: cells are taken for what was there before.
  float keep_step = 0.15F;
  float limit = 4.0F;  ///< log-odds stay within this
  EgoMotionOptions ego;
  /// The room's, which count in full for the camera's motion as what has long stood still does.
  PlaneOptions planes = larger_than_people({});
  /// Those that have long been there count alone, also where people hide most of them: two backs
  /// side by side are as large for a moment.
  StaticPlanesOptions static_planes;
  BackgroundOptions background;
  MotionEvidenceOptions evidence;
  MotionRegionOptions regions;

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// The model-free detector: finds what moves by itself, whatever it is. No learning and no classes.
///
/// Each frame: the camera's own motion from sparse flow outside of what moved before, on large
/// planes and on what has long stood still above all; a background
/// of all static surfaces seen so far, carried along with it; two kinds of evidence for every cell
/// of a coarse grid (a point where the background was seen to be free; dense flow that disagrees
/// with the camera's motion), gathered as log-odds which travel with the objects; regions grown
/// from the cells that moved over neighbours of like depth.
///
/// What stands still is not found, whatever it is; neither is what fills most of the image from the
/// first frame on, unless a large plane is in view. Frames must come in order.
class MotionDetector : public Detector {
 public:
  /// Throws `Error` when the camera makes no sense.
  explicit MotionDetector(const Camera& camera, const MotionDetectorOptions& options = {});
  MotionDetector(const MotionDetector&) = delete;  // parts refer to the grid
  MotionDetector& operator=(const MotionDetector&) = delete;

  std::string name() const override { return "motion"; }
  /// Throws `Error` when an image is missing or not of the camera's size.
  std::vector<Detection> detect(const RgbdFrame& frame) override;

 private:
  struct Past {
    double timestamp = 0.0;
    CoarseView view;
    Se3 current_from_past;
  };

  void check(const RgbdFrame& frame) const;
  void restart();
  /// To a view of which nobody knows how the camera came there: what moved is still there, and the
  /// room's planes are known; how the room looked is not.
  void go_on_without_motion(const CoarseView& view);
  /// What moves, without the room's planes that regions grew over. The camera's motion is found
  /// without those parts, too: an arm that leans on a desk is not told from it (measured: worse).
  std::vector<Detection> found(const cv::Size& image_size) const;
  const Past& flow_partner(double timestamp) const;
  /// How much each cell of the last frame says about the camera's motion, 0 to 1.
  cv::Mat trust() const;
  MotionEvidence find_evidence(const CoarseView& view, const Past& partner) const;
  void find_planes(const RgbdFrame& frame, const Se3& current_from_previous);
  void carry(const CoarseView& view, const cv::Mat& flow, float share, double seconds);
  void gather(const CoarseView& view, const cv::Mat& depth_evidence, const MotionEvidence& motion,
              double seconds);

  Camera camera_;
  MotionDetectorOptions options_;
  CoarseGrid grid_;
  EgoMotionEstimator ego_;
  BackgroundModel background_;
  MotionEvidenceFinder evidence_;
  std::deque<Past> past_;
  cv::Mat log_odds_;  ///< CV_32FC1, of motion
  cv::Mat standing_;  ///< CV_32FC1, seconds since the cell's point came and stands still
  cv::Mat moving_;    ///< CV_8UC1, mask of the last frame
  StaticPlanes planes_;
  cv::Mat on_planes_;  ///< CV_8UC1, 255 where the last frame shows one of them
  cv::Mat rays_;       ///< of a `DepthView`
};

}  // namespace dkp_slam
