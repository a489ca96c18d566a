#pragma once

#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "dkp_slam/feature/descriptor.h"

namespace dkp_slam {

class OptionList;

struct OrbOptions {
  int features = 1000;  ///< per image, as ORB-SLAM3's RGB-D settings for the TUM sequences
  int levels = 8;       ///< of the image pyramid
  float scale = 1.2F;   ///< between two levels
  /// Side length to which images are enlarged before corners are sought: corners are found to a
  /// pixel, so that those of a small image have coarse directions. Level 0 is the enlarged image.
  double enlargement = 1.0;
  int fast_threshold = 20;     ///< grey levels
  int fast_low_threshold = 7;  ///< where a cell shows no corner at the first

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// ORB features of one image.
struct OrbFeatures {
  /// Raw pixels of the full-size image, angle in degrees, octave = pyramid level, ordered by level.
  std::vector<cv::KeyPoint> keypoints;
  std::vector<Descriptor> descriptors;  ///< one per keypoint
  /// All corners of each level that the keypoints were chosen from, pixels of the level.
  std::vector<std::vector<cv::KeyPoint>> corners;
  std::vector<cv::Mat> levels;  ///< the image at each level, CV_8UC1
};

/// ORB (Rublee et al. 2011) with corners spread over the image by a quad-tree, as ORB-SLAM does
/// (Mur-Artal et al. 2015, §V): FAST in each pyramid level, at a lower threshold where a cell stays
/// empty, the strongest corner of each of the tree's leaves, intensity-centroid orientation, and
/// OpenCV's steered BRIEF.
class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbOptions& options = {});

  /// `grey`: CV_8UC1. Deterministic.
  OrbFeatures extract(const cv::Mat& grey) const;

  /// As many features as an image gets where `allowed` (CV_8UC1, size of the image) is not 0, from
  /// the corners of `found` (by an extractor of the same levels), but for those that `found` has
  /// already. The result has no corners of its own.
  OrbFeatures extract_more(const OrbFeatures& found, const cv::Mat& allowed) const;

  const OrbOptions& options() const { return options_; }
  /// Side length of a pixel of a level in pixels of level 0.
  float scale_of(int level) const { return scales_[static_cast<std::size_t>(level)]; }

 private:
  /// Level 0 of an image and the sizes of all its levels.
  cv::Mat ground_of(const cv::Mat& grey) const;
  std::vector<cv::Size> level_sizes(const cv::Size& ground) const;
  std::vector<cv::KeyPoint> find_corners(const cv::Mat& image) const;
  /// The best of them, spread over the level.
  std::vector<cv::KeyPoint> spread(const std::vector<cv::KeyPoint>& corners, const cv::Size& image,
                                   int level) const;
  /// Features at corners of a level, in pixels of the image.
  OrbFeatures describe(const cv::Mat& image, std::vector<cv::KeyPoint> corners, int level) const;
  /// Corner of a level in pixels of the image.
  cv::Point2f image_pixel(const cv::Point2f& corner, int level) const;
  void add_angles(const cv::Mat& image, std::vector<cv::KeyPoint>& keypoints) const;

  OrbOptions options_;
  std::vector<float> scales_;
  std::vector<int> wanted_per_level_;
  std::vector<int> patch_row_half_width_;
  std::vector<cv::Ptr<cv::ORB>> describers_;  // one per level: levels run at the same time
};

/// Keeps at most about `wanted` keypoints, the strongest of each leaf of a quad-tree over `area`
/// (x, y, width, height in the keypoints' own pixels), so that they spread evenly.
std::vector<cv::KeyPoint> spread_by_quadtree(const std::vector<cv::KeyPoint>& keypoints,
                                             const cv::Rect2f& area, int wanted);

}  // namespace dkp_slam
