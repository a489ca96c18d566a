#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace dkp_slam {

/// What the ray through a pixel's centre found.
struct SeenPoint {
  int surface = -1;  ///< -1: nothing; the rest is then without meaning
  int triangle = 0;
  Eigen::Vector3f point, normal;                     ///< as in `HitPlane`
  Eigen::Vector2f motion = Eigen::Vector2f::Zero();  ///< in the image over the exposure, pixels
};

/// Neighbours on different surfaces, or on parts of one that no smooth surface joins.
bool is_edge(const SeenPoint& a, const SeenPoint& b);

/// How many rays each pixel of a frame needs: one, but several where an edge touches it during the
/// exposure.
class EdgeMarks {
 public:
  static constexpr int most_samples = 16;  ///< of a pixel, however fast things move
  /// `samples` is the least number at an edge, 1 to `most_samples`.
  EdgeMarks(cv::Size image, int samples, cv::Mat* memory);

  /// Marks all edges between row y and its neighbours to the right and below. Rows may be marked
  /// on several threads at once; `seen` holds the image row by row, `radiance` its colours so far.
  void mark_row(int y, const std::vector<SeenPoint>& seen, const cv::Mat& radiance);
  const std::uint8_t* row(int y) const { return marks_.ptr<std::uint8_t>(y); }

 private:
  void mark(int x, int y, const Eigen::Vector2f& motion);

  const int samples_;
  cv::Mat& marks_;  ///< CV_8UC1
};

}  // namespace dkp_slam
