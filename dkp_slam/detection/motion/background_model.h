#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "dkp_slam/detection/motion/coarse_grid.h"
#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

class OptionList;

struct BackgroundOptions {
  /// Tolerance of the comparison: constant (metres), plus this many standard deviations of the
  /// depth noise. Wide, because colour and depth are up to 20 ms apart and lens models imperfect.
  double tolerance = 0.05;
  double tolerance_sigmas = 4.0;
  float blend = 0.3F;  ///< share of the new reading when a point is seen again
  int max_age = 255;   ///< frames; older points count as this old

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// How a cell's depth compares with the model.
enum class DepthEvidence : std::uint8_t {
  unknown,     ///< no depth, or no model there
  consistent,  ///< the model's surface
  nearer,      ///< in space that was seen to be free: something came
  farther,     ///< behind the model's surface: something left
};

/// The static surface as far as it was seen, one point per cell of the grid, carried along with
/// the camera. Points keep their exact position when carried, so that cells do not blur.
class BackgroundModel {
 public:
  BackgroundModel(const CoarseGrid& grid, const Camera& camera,
                  const BackgroundOptions& options = {});

  /// Carries the model into the camera frame of the next image, whose rows are of these moments.
  void move(const Se3& current_from_previous, const RowMotion& rows);
  /// Compares depth (metres, grid size) with the model; CV_8UC1 of `DepthEvidence`.
  cv::Mat compare(const cv::Mat& depth) const;
  /// Takes in the depth of the view that the model was carried to: blends what is consistent,
  /// replaces what `evidence` shows to have left, and fills unknown cells; cells of `moving`
  /// (CV_8UC1) stay as they are unless something left there. Cells of `absorb` (CV_8UC1) take the
  /// new depth whatever the model says.
  void update(const CoarseView& view, const cv::Mat& evidence, const cv::Mat& moving,
              const cv::Mat& absorb);
  /// Frames in which the cell's point has been seen, 0 without a point.
  int age(int index) const { return cells_[static_cast<std::size_t>(index)].age; }
  void clear();

 private:
  struct Cell {
    Eigen::Vector3f point = Eigen::Vector3f::Zero();  // at the middle row's moment
    int age = 0;
    float depth = 0.0F;  // metres, as the point's row shows it
  };

  float tolerance_at(float depth) const;

  const CoarseGrid& grid_;
  DepthNoise noise_;
  BackgroundOptions options_;
  std::vector<Cell> cells_, moved_;
};

}  // namespace dkp_slam
