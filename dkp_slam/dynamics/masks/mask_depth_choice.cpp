#include "dkp_slam/dynamics/masks/mask_depth_choice.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/geometry/planes/depth_view.h"

namespace dkp_slam {
namespace {

constexpr int fewest_pixels = 30;   // of the view, for a comparison
constexpr double sure_times = 2.0;  // the sigmas that a choice takes

cv::Mat seen_by_view(const cv::Mat& image) {
  cv::Mat view;
  cv::resize(image, view, {image.cols / DepthView::step, image.rows / DepthView::step}, 0, 0,
             cv::INTER_NEAREST);
  return view;
}

/// The mask's outermost pixels; those at the image's edge are no outline.
cv::Mat outline(const cv::Mat& mask) {
  cv::Mat inside;
  cv::erode(mask, inside, cv::Mat::ones(3, 3, CV_8U), {-1, -1}, 1, cv::BORDER_REPLICATE);
  return mask & ~inside;
}

cv::Mat away_from(const cv::Mat& outline, const cv::Mat& other) {
  cv::Mat near;
  cv::dilate(other, near, cv::Mat::ones(3, 3, CV_8U));
  return outline & ~near;
}

cv::Mat gradient(const cv::Mat& grey) {
  cv::Mat x, y, both;
  constexpr double per_pixel = 1.0 / 8.0;  // of Sobel's kernel
  cv::Sobel(grey, x, CV_32F, 1, 0, 3, per_pixel);
  cv::Sobel(grey, y, CV_32F, 0, 1, 3, per_pixel);
  cv::magnitude(x, y, both);
  return both;
}

}  // namespace

OutlineGradients outline_gradients(const cv::Mat& grey, const cv::Mat& first,
                                   const cv::Mat& second) {
  const cv::Mat a = outline(seen_by_view(first) != 0), b = outline(seen_by_view(second) != 0);
  const cv::Mat only_a = away_from(a, b), only_b = away_from(b, a);
  OutlineGradients result;
  result.pixels = std::min(cv::countNonZero(only_a), cv::countNonZero(only_b));
  if (result.pixels == 0) return result;
  const cv::Mat slope = gradient(seen_by_view(grey));
  result.first = cv::mean(slope, only_a)[0];
  result.second = cv::mean(slope, only_b)[0];
  return result;
}

bool MaskDepthChoice::wants_comparison() {
  if (options_.every <= 0) return false;
  const bool sure = sigmas_of_sum() > sure_times * options_.sigmas;
  return frame_++ % (sure ? 2 * options_.every : options_.every) == 0;
}

void MaskDepthChoice::compare(const cv::Mat& grey, const cv::Mat& by_moment,
                              const cv::Mat& by_stamp) {
  const OutlineGradients g = outline_gradients(grey, by_moment, by_stamp);
  if (g.pixels < fewest_pixels) return;
  const double difference = (g.second - g.first) / std::max(g.first + g.second, 1e-6);
  // Who moves little tells little, and needs it little.
  const double weight = static_cast<double>(g.pixels) * g.pixels;
  sum_ = options_.forget * sum_ + weight * difference;
  squares_ = options_.forget * options_.forget * squares_ + weight * weight;
  if (sigmas_of_sum() > options_.sigmas) stamped_ = sum_ > 0.0;
}

double MaskDepthChoice::sigmas_of_sum() const {
  return squares_ > 0.0 ? std::abs(sum_) / (options_.spread * std::sqrt(squares_)) : 0.0;
}

}  // namespace dkp_slam
