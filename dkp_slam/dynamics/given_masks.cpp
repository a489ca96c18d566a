#include "dkp_slam/dynamics/given_masks.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/dynamics/compensation/object_flow.h"

namespace dkp_slam {
namespace {

constexpr int most_pieces = 255;  // labels are bytes

cv::Mat pieces_of(const cv::Mat& mask) {
  cv::Mat pieces, labels;
  cv::connectedComponents(mask != 0, pieces);
  cv::min(pieces, most_pieces, pieces);
  pieces.convertTo(labels, CV_8U);
  return labels;
}

}  // namespace

cv::Mat GivenMasks::carried(const std::vector<cv::Point2f>& points,
                            const FlowResult& tracks) const {
  const auto flow = object_flow(points, tracks, labels_, most_pieces);
  double highest = 0.0;
  cv::minMaxLoc(labels_, nullptr, &highest);
  cv::Mat moved = cv::Mat::zeros(labels_.size(), CV_8UC1);
  for (int label = 1; label <= static_cast<int>(highest); ++label) {
    const cv::Point2f shift = flow[static_cast<std::size_t>(label) - 1].value_or(cv::Point2f());
    cv::Mat piece;
    cv::warpAffine(labels_ == label, piece, cv::Matx23f(1, 0, shift.x, 0, 1, shift.y),
                   labels_.size(), cv::INTER_NEAREST);
    moved.setTo(label, piece);
  }
  return moved;
}

cv::Mat GivenMasks::labels(const RgbdFrame& frame, const std::vector<cv::Point2f>& points,
                           const FlowResult& tracks) {
  if (!frame.mask.empty()) {
    labels_ = pieces_of(frame.mask);
    given_ = frame.timestamp;
  } else if (labels_.empty() || frame.timestamp - given_ > carry_seconds_) {
    labels_ = cv::Mat::zeros(frame.colour.size(), CV_8UC1);
  } else {
    labels_ = carried(points, tracks);
  }
  return labels_;
}

}  // namespace dkp_slam
