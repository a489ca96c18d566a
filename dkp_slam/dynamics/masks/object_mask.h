#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/planes/depth_view.h"

namespace dkp_slam {

/// Silhouette of one object in pixels of the view.
struct ObjectMask {
  cv::Rect area;            ///< pixels of the view
  cv::Mat mask;             ///< CV_8UC1, size of `area`, 255 on the object
  float mean_depth = 0.0F;  ///< T, metres; 0 when the mask is empty
  float share = 0.0F;       ///< R: mask pixels over the box's pixels with a known depth
  int clusters = 0;         ///< K that was used
  bool moving = false;      ///< its main surface is proved to move
  bool still = false;       ///< its main surface is proved to stand still
  bool empty() const { return mean_depth <= 0.0F; }
};

/// Calls `visit(x, y)` for every pixel of the area, row by row.
template <typename F>
void for_each_pixel(const cv::Rect& area, F&& visit) {
  for (int y = area.y; y < area.y + area.height; ++y) {
    for (int x = area.x; x < area.x + area.width; ++x) visit(x, y);
  }
}

/// Mask of an object whose detector knows the silhouette (CV_8UC1, size of `box` rounded outwards).
ObjectMask mask_from_silhouette(const DepthView& view, const cv::Mat& silhouette,
                                const cv::Rect2f& box);

/// Pixels of the view that two masks share.
int mask_overlap(const ObjectMask& a, const ObjectMask& b);

/// Writes `label` where the object is into `labels` (CV_8UC1, image size).
void paint_object(const ObjectMask& object, std::uint8_t label, cv::Mat& labels);

/// Box in pixels of the view, clipped to it, for one in pixels of the image.
cv::Rect view_rect(const cv::Rect2f& box, const cv::Size& view_size);

/// Sets T and R from the mask's pixels; `box` in pixels of the view.
void measure_mask(const DepthView& view, const cv::Rect& box, ObjectMask& mask);

}  // namespace dkp_slam
