#include "dkp_slam/dynamics/motion/flow.h"

#include <opencv2/video/tracking.hpp>

namespace dkp_slam {

void BackwardFlow::push(const cv::Mat& grey) {
  std::vector<cv::Mat> pyramid;
  if (earlier_frames() == options_.history) {
    // In the oldest one's memory: 2 MB anew from the system take a third of the time.
    pyramid = std::move(pyramids_.back());
    pyramids_.pop_back();
  }
  // With a copy of `grey`, which is not ours to write to when its turn comes.
  constexpr bool reuse_input = false;
  cv::buildOpticalFlowPyramid(grey, pyramid, window(), options_.levels, true,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, reuse_input);
  pyramids_.push_front(std::move(pyramid));
}

FlowResult BackwardFlow::track(const std::vector<cv::Point2f>& points, int frames_back,
                               const std::vector<cv::Point2f>& guess) const {
  FlowResult result;
  result.previous = guess.empty() ? points : guess;
  result.tracked.assign(points.size(), 0);
  if (points.empty()) return result;
  const auto& now = pyramids_.front();
  const auto& then = pyramids_.at(static_cast<std::size_t>(frames_back));
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, options_.iterations,
                              options_.epsilon);
  // The way back starts where it should end: a true match stays there, a wrong one drifts off, and
  // coarse levels would only cost time.
  constexpr int back_level = 0;
  std::vector<cv::Point2f> back = points;
  std::vector<std::uint8_t> found_back;
  cv::calcOpticalFlowPyrLK(now, then, points, result.previous, result.tracked, cv::noArray(),
                           window(), options_.levels, stop, cv::OPTFLOW_USE_INITIAL_FLOW);
  cv::calcOpticalFlowPyrLK(then, now, result.previous, back, found_back, cv::noArray(), window(),
                           back_level, stop, cv::OPTFLOW_USE_INITIAL_FLOW);
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
