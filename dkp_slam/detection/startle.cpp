#include "dkp_slam/detection/startle.h"

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

}  // namespace

bool Startle::somebody_came(double time, const cv::Mat& depth) {
  constexpr int step = 16;         // pixels
  constexpr float nearer = 0.25F;  // metres
  cv::Mat now;
  if (!depth.empty()) {
    cv::resize(depth, now, {depth.cols / step, depth.rows / step}, 0, 0, cv::INTER_NEAREST);
  }
  std::swap(now, before_);
  if (!now.empty() && now.size() == before_.size()) {
    const int came = cv::countNonZero((before_ > 0.0F) & (now > before_ + nearer));
    if (came >= least_ * static_cast<double>(now.total())) came_ = time;
  }
  return just_after(came_, time);
}

bool Startle::by(double time, const cv::Mat& depth) {
  if (!last_ || time < *last_ || time - *last_ > gap) began_ = time;
  last_ = time;
  return somebody_came(time, depth) || just_after(began_, time);
}

}  // namespace dkp_slam
