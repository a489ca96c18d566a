#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// When and how `lucas_kanade` searches.
struct LucasKanadeSearch {
  cv::Size window;       ///< pixels of each level
  int levels = 2;        ///< coarser levels at most
  int iterations = 10;   ///< on each level
  double epsilon = 0.1;  ///< pixels of a level; a smaller step ends the iteration
  /// With the instructions that every processor has, though this one has more.
  bool baseline = false;
};

/// `image` (CV_8UC1) and its halves, as many as the search uses, each inside of a border as wide as
/// the window. A pyramid that is given is overwritten, in its memory.
void make_pyramid(const cv::Mat& image, const LucasKanadeSearch& search,
                  std::vector<cv::Mat>& pyramid);

/// Pyramidal Lucas-Kanade flow (Bouguet, "Pyramidal implementation of the Lucas Kanade feature
/// tracker", 2001): where the pixels `points` of the image of `from` are in that of `to`. `found`
/// holds where the search begins, in pixels, and then where it ended; the result is 1 where that is
/// a match, 0 where the window has no texture in two directions or leaves the image.
///
/// Meant for some hundred points: gradients are those of the windows, not of the whole image.
/// Gives the same bits with whatever instructions the machine has.
std::vector<std::uint8_t> lucas_kanade(const std::vector<cv::Mat>& from,
                                       const std::vector<cv::Mat>& to,
                                       const std::vector<cv::Point2f>& points,
                                       std::vector<cv::Point2f>& found,
                                       const LucasKanadeSearch& search);

}  // namespace dkp_slam
