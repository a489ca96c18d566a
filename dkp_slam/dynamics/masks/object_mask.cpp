#include "dkp_slam/dynamics/masks/object_mask.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {

void measure_mask(const DepthView& view, const cv::Rect& box, ObjectMask& mask) {
  double sum = 0.0;
  int count = 0, inside = 0, known = 0;
  for_each_pixel(mask.area, [&](int x, int y) {
    if (mask.mask.at<std::uint8_t>(y - mask.area.y, x - mask.area.x) == 0) return;
    sum += static_cast<double>(view.depth.at<float>(y, x));
    ++count;
    inside += box.contains({x, y}) ? 1 : 0;
  });
  for_each_pixel(box, [&](int x, int y) { known += view.depth.at<float>(y, x) > 0.0F ? 1 : 0; });
  if (count == 0 || known == 0) return;
  mask.mean_depth = static_cast<float>(sum / count);
  mask.share = static_cast<float>(inside) / static_cast<float>(known);
}

cv::Rect view_rect(const cv::Rect2f& box, const cv::Size& view_size) {
  constexpr auto step = static_cast<float>(DepthView::step);
  const int x0 = static_cast<int>(std::floor(box.x / step));
  const int y0 = static_cast<int>(std::floor(box.y / step));
  const int x1 = static_cast<int>(std::ceil((box.x + box.width) / step));
  const int y1 = static_cast<int>(std::ceil((box.y + box.height) / step));
  return cv::Rect(x0, y0, x1 - x0, y1 - y0) & cv::Rect(0, 0, view_size.width, view_size.height);
}

void paint_object(const ObjectMask& object, std::uint8_t label, cv::Mat& labels) {
  constexpr int step = DepthView::step;
  const cv::Rect whole(object.area.tl() * step, object.area.size() * step);
  const cv::Rect pixels = whole & cv::Rect(0, 0, labels.cols, labels.rows);
  cv::Mat mask;
  cv::resize(object.mask, mask, whole.size(), 0, 0, cv::INTER_NEAREST);
  labels(pixels).setTo(label, mask(pixels - whole.tl()));
}

ObjectMask mask_from_silhouette(const DepthView& view, const cv::Mat& silhouette,
                                const cv::Rect2f& box) {
  ObjectMask out;
  out.area = view_rect(box, view.depth.size());
  out.mask = cv::Mat::zeros(out.area.size(), CV_8UC1);
  const cv::Point origin(static_cast<int>(std::floor(box.x)), static_cast<int>(std::floor(box.y)));
  const cv::Rect inside(0, 0, silhouette.cols, silhouette.rows);
  for_each_pixel(out.area, [&](int x, int y) {
    const cv::Point p = cv::Point(x * DepthView::step, y * DepthView::step) - origin;
    if (inside.contains(p) && silhouette.at<std::uint8_t>(p) != 0) {
      out.mask.at<std::uint8_t>(y - out.area.y, x - out.area.x) = 255;
    }
  });
  measure_mask(view, out.area, out);
  out.moving = true;
  return out;
}

int mask_overlap(const ObjectMask& a, const ObjectMask& b) {
  if (a.empty() || b.empty()) return 0;
  const cv::Rect common = a.area & b.area;
  if (common.area() == 0) return 0;
  return cv::countNonZero(a.mask(common - a.area.tl()) & b.mask(common - b.area.tl()));
}

}  // namespace dkp_slam
