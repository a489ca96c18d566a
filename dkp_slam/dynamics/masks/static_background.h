#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/dynamics/masks/object_mask.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/planes/depth_view.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

class OptionList;

struct StaticBackgroundOptions {
  /// Metres between a depth and the background's, at no depth, and what depth squared adds
  /// (1/metre), within which they are one surface.
  double tolerance_constant = 0.02;
  double tolerance_quadratic = 0.005;
  /// Metres, at no depth, from which on something is in front of the background.
  double front = 0.06;
  double grey_difference = 20.0;  ///< grey levels by which the same surface may look different
  /// Seconds for which a surface must have been seen in its place, away from everybody, to be
  /// known.
  double proof = 0.3;
  double memory = 4.0;  ///< seconds that what is hidden is remembered
  int opening = 3;      ///< pixels of the view: smaller pieces of background stay in a mask

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// The surfaces that were seen standing still before somebody came: what a mask takes of them, a
/// monitor at a person's depth, is given back, and what is in front of them in a person's box
/// belongs to the mask. A grid of points in the camera's frame, carried along with its motion.
class StaticBackground {
 public:
  StaticBackground(const Camera& camera, const StaticBackgroundOptions& options);

  /// Takes the points along with the camera. To be called once for every frame.
  void move(const Se3& current_from_previous);
  void forget();  ///< where the camera's motion is unknown
  /// Gives back and adds to a mask, inside of `box` (pixels of the image), what the comparison with
  /// a frame tells: `view` and `grey` (CV_8UC1, image size).
  void correct(const DepthView& view, const cv::Mat& grey, const cv::Rect2f& box, ObjectMask& mask);
  /// CV_8UC1, size of the view: 255 where what is seen is a surface that was seen standing still.
  cv::Mat known(const DepthView& view, const cv::Mat& grey);
  /// Learns what lies outside of `hidden`, boxes in pixels of the image.
  void learn(const DepthView& view, const cv::Mat& grey, const std::vector<cv::Rect2f>& hidden,
             double time);

 private:
  struct Point {
    Eigen::Vector3f at = Eigen::Vector3f::Zero();  ///< metres, camera frame; z of 0: none
    double since = 0.0;                            ///< seconds
    double seen = 0.0;                             ///< seconds
    std::uint8_t grey = 0;
  };

  /// Of the points, as they are now, those of surfaces that stood still for long enough.
  struct Proven {
    bool current = false;
    std::vector<float> depth;  ///< metres, 0: none
    std::vector<std::uint8_t> grey;
    std::vector<float> nearest, farthest;  ///< of a cell and the four beside it; infinite: none
  };

  void list_proven();
  bool is_known(std::size_t cell, float z, float same, std::uint8_t grey) const;
  /// Of an area of the view, CV_8UC1: 255 on known background, and on what is in front of it
  /// (null: nobody asks).
  void compare(const DepthView& view, const cv::Mat& grey, const cv::Rect& area, cv::Mat& known,
               cv::Mat* in_front);
  int cell_of(const Eigen::Vector3f& p) const;
  float tolerance(float depth) const;
  double since_beside(int c, float z, double time) const;
  void cut_known(const cv::Mat& known, cv::Mat& mask) const;

  StaticBackgroundOptions options_;
  float fx_, fy_, cx_, cy_;  // of the grid
  cv::Size grid_;
  cv::Mat cells_;  // CV_32SC1, view size: each pixel's cell, or -1
  std::vector<Point> points_;
  std::vector<Point> moved_;  // scratch
  Proven proven_;
};

}  // namespace dkp_slam
