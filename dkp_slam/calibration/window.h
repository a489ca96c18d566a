#pragma once

#include <vector>

#include "dkp_slam/calibration/motion_spline.h"
#include "dkp_slam/calibration/parameters.h"
#include "dkp_slam/calibration/sighting_terms.h"
#include "dkp_slam/calibration/sightings.h"

namespace dkp_slam {

/// A landmark of a window.
struct WindowPoint {
  int landmark = 0;
  Eigen::Vector3d position;  ///< metres, in the window's frame
  std::vector<TimedSighting> seen;
};

/// A second or two of a sequence, by itself: its own landmarks and its own motion, in the frame of
/// the camera in the middle of it.
struct Window {
  double begin = 0.0, end = 0.0;  ///< seconds
  Se3 world_from_window;
  MotionSpline motion;
  std::vector<WindowPoint> points;
};

struct WindowOptions {
  /// Long enough that the camera's speed changes in it, which is what shows the readout, and short
  /// enough that most of its landmarks stay in view.
  double length = 1.5;  ///< seconds
  int points = 150;     ///< landmarks at most, those seen most often
  int least_seen = 6;   ///< sightings of a landmark
  int least_points = 25;
  int most_windows = 40;  ///< those in which the speed changes most
};

/// Cuts a sequence into windows. None where frames are too few or too far apart.
std::vector<Window> make_windows(const std::vector<SightedFrame>& frames, const Camera& camera,
                                 const WindowOptions& options);

/// How fast what is seen moves across the image: root mean square, pixels per second.
double image_speed(const std::vector<Window>& windows, const Parameters& parameters);

/// Standard deviations of what is measured, as they turn out.
struct MeasuredNoise {
  double pixel = 0.7;  ///< pixels, of a feature of the finest level
  double depth = 1.0;  ///< of a patch's inverse depth, in those of one reading by the camera file
};

}  // namespace dkp_slam
