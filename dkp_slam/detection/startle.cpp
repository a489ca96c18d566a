#include "dkp_slam/detection/startle.h"

#include <algorithm>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

constexpr double a_few_images = 0.08;  // seconds: three at 30 Hz
constexpr double gap = 0.1;            // seconds in which somebody walks in

/// Whether `time` lies within a few images after `event`; not where the clock was set back.
bool just_after(const std::optional<double>& event, double time) {
  return event && time >= *event && time < *event + a_few_images;
}

/// Depth on a grid of 40 columns; empty for none.
cv::Mat sampled(const cv::Mat& depth) {
  constexpr int columns = 40;
  cv::Mat grid;
  if (depth.empty()) return grid;
  const int rows = std::max(1, depth.rows * columns / depth.cols);
  cv::resize(depth, grid, {columns, rows}, 0, 0, cv::INTER_NEAREST);
  return grid;
}

/// Where something is nearer than all that lay about it before. Edges that a turning camera moves
/// lie about it, too: 32 pixels of 640 in a thirtieth of a second are 100 degrees a second.
cv::Mat come_nearer(const cv::Mat& before, const cv::Mat& now) {
  constexpr int about = 2;                                   // cells
  constexpr double far = 1000.0;                             // metres: unknown depth hides nothing
  constexpr double nearer_share = 0.1, nearer_metres = 0.1;  // than a camera comes in an image
  cv::Mat known = before.clone(), nearest;
  known.setTo(far, before <= 0.0F);
  cv::erode(known, nearest, cv::Mat::ones(2 * about + 1, 2 * about + 1, CV_8UC1));
  const cv::Mat enough = nearest * (1.0 - nearer_share) - nearer_metres;
  return (now > 0.0F) & (nearest < far) & (now < enough);
}

}  // namespace

bool Startle::somebody_came(double time, const cv::Mat& depth) {
  const cv::Mat before = std::exchange(before_, sampled(depth));
  if (!before_.empty() && before_.size() == before.size()) {
    const int came = cv::countNonZero(come_nearer(before, before_));
    if (came >= least_ * static_cast<double>(before.total())) came_ = time;
  }
  return just_after(came_, time);
}

bool Startle::by(double time, const cv::Mat& depth) {
  if (!last_ || time < *last_ || time - *last_ > gap) began_ = time;
  last_ = time;
  return somebody_came(time, depth) || just_after(began_, time);
}

}  // namespace dkp_slam
