#pragma once

#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "dkp_slam/calibration/window.h"

namespace dkp_slam {

/// What is left of a window's normal equations when its motion and landmarks are eliminated.
struct ReducedSystem {
  ParameterMatrix h = ParameterMatrix::Zero();
  Parameters g = Parameters::Zero();
  double cost = 0.0;
};

/// A window while it is adjusted.
class WindowSystem {
 public:
  WindowSystem(Window& window, const Camera& camera, bool lens);

  /// Linearises and eliminates; `damping`: Marquardt's, relative to the diagonal.
  ReducedSystem reduce(const Parameters& parameters, const MeasuredNoise& noise, double damping);
  /// Moves motion and landmarks by what goes with this step of the parameters. Returns the cost
  /// there. After `reduce`; to be followed by `keep` or `undo`.
  double step(const Parameters& from, const Parameters& step, const MeasuredNoise& noise);
  void undo();

  /// Errors over the noise that each has by itself: pixels of each coordinate, inverse depths.
  void errors(const Parameters& parameters, std::vector<double>& pixels,
              std::vector<double>& depths) const;

 private:
  /// Normal equations of the landmarks, three rows each.
  struct PointRows {
    std::vector<Eigen::Matrix3d> h;
    Eigen::VectorXd g;
    Eigen::MatrixXd by_motion, by_parameter;
  };

  double inverse_sigma(const TimedSighting& seen) const;
  double cost(const Parameters& parameters, const MeasuredNoise& noise) const;
  void add_priors();
  void add_all(const Parameters& parameters, const MeasuredNoise& noise);
  template <int Rows>
  void add(const ErrorTerm<Rows>& term, double sigma, std::size_t point);
  void eliminate_points(double damping);

  Window& window_;
  const Camera& camera_;
  bool lens_;
  MotionSpline::Controls first_controls_, old_controls_;
  std::vector<Eigen::Vector3d> old_points_;
  PointRows points_;
  Eigen::MatrixXd h_;             ///< of the motion
  Eigen::VectorXd g_;             ///< of the motion
  Eigen::MatrixXd by_parameter_;  ///< motion by parameters
  ReducedSystem reduced_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace dkp_slam
