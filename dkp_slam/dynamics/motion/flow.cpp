#include "dkp_slam/dynamics/motion/flow.h"

namespace dkp_slam {

LucasKanadeSearch BackwardFlow::search(int levels) const {
  return {.window = {options_.window_width, options_.window_height},
          .levels = levels,
          .iterations = options_.iterations,
          .epsilon = options_.epsilon};
}

void BackwardFlow::push(const cv::Mat& grey) {
  std::vector<cv::Mat> pyramid;
  if (earlier_frames() == options_.history) {
    // In the oldest one's memory: 2 MB anew from the system take a third of the time.
    pyramid = std::move(pyramids_.back());
    pyramids_.pop_back();
  }
  make_pyramid(grey, search(options_.levels), pyramid);
  pyramids_.push_front(std::move(pyramid));
}

FlowResult BackwardFlow::track(const std::vector<cv::Point2f>& points, int frames_back,
                               const std::vector<cv::Point2f>& guess) const {
  FlowResult result;
  result.previous = guess.empty() ? points : guess;
  const auto& now = pyramids_.front();
  const auto& then = pyramids_.at(static_cast<std::size_t>(frames_back));
  result.tracked = lucas_kanade(now, then, points, result.previous, search(options_.levels));
  // The way back starts where it should end: a true match stays there, a wrong one drifts off, and
  // coarse levels would only cost time.
  std::vector<cv::Point2f> back = points;
  const auto found_back = lucas_kanade(then, now, result.previous, back, search(0));
  const cv::Rect2f image(0.0F, 0.0F, static_cast<float>(then[0].cols),
                         static_cast<float>(then[0].rows));
  const double limit = options_.forward_backward * options_.forward_backward;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f d = back[i] - points[i];
    const bool ok = found_back[i] != 0 && d.dot(d) < limit && image.contains(result.previous[i]);
    if (!ok) result.tracked[i] = 0;
  }
  return result;
}

}  // namespace dkp_slam
