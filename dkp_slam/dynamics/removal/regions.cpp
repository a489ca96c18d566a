#include "dkp_slam/dynamics/removal/regions.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/geometry/nearest_pixel.h"

namespace dkp_slam {

int label_at(const cv::Mat& labels, const cv::Point2f& p) {
  return labels.at<std::uint8_t>(nearest_pixel(labels.size(), p));
}

cv::Mat masks_and_outlines(const cv::Mat& labels, int margin) {
  cv::Mat masks = labels > 0;
  const int side = 2 * margin + 1;
  cv::dilate(masks, masks, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return masks;
}

float object_weight(float class_weight, const RegionOptions& options) {
  const float share = std::clamp((class_weight - 1.0F) / 9.0F, 0.0F, 1.0F);
  return options.weight_low + (options.weight_high - options.weight_low) * share;
}

float suspicious_weight(float distance, float max_distance, float suspicious_share,
                        float weight_high, const RegionOptions& options) {
  const float relative =
      max_distance > 0.0F ? std::clamp(distance / max_distance, 0.0F, 1.0F) : 0.0F;
  const float fall = std::pow(1.0F - relative, suspicious_share);
  const float span = weight_high - options.weight_low;
  return options.printed_equation ? weight_high - span * fall : options.weight_low + span * fall;
}

void assign_regions(const std::vector<cv::Point2f>& keypoints,
                    const std::vector<ObjectRegions>& objects, const cv::Mat& labels,
                    std::vector<FeatureDynamics>& features) {
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const bool in_mask = label_at(labels, keypoints[i]) > 0;
    const bool in_box = std::any_of(objects.begin(), objects.end(), [&](const ObjectRegions& o) {
      return o.box.contains(keypoints[i]);
    });
    features[i].region = in_mask ? Region::high : in_box ? Region::suspicious : Region::low;
  }
}

void assign_weights(const std::vector<cv::Point2f>& keypoints,
                    const std::vector<ObjectRegions>& objects, const cv::Mat& labels,
                    const RegionOptions& options, std::vector<FeatureDynamics>& features) {
  for (FeatureDynamics& f : features) f.weight = options.weight_low;
  for (std::size_t o = 0; o < objects.size(); ++o) {
    const cv::Rect box = cv::Rect(objects[o].box) & cv::Rect(0, 0, labels.cols, labels.rows);
    if (box.area() == 0) continue;
    const float high = object_weight(objects[o].weight, options);
    const auto own = static_cast<std::uint8_t>(o + 1);
    const cv::Mat outside = labels(box) != own;
    const float share =
        static_cast<float>(cv::countNonZero(outside)) / static_cast<float>(box.area());
    cv::Mat distance;
    if (cv::countNonZero(outside) < box.area()) {
      cv::distanceTransform(outside, distance, cv::DIST_L2, 3);
    }
    std::vector<std::size_t> in_box;
    float farthest = 0.0F;
    const auto distance_of = [&](std::size_t i) {
      if (distance.empty()) return 0.0F;  // no mask: all of the box is as suspicious as its edge
      return distance.at<float>(std::clamp(cvRound(keypoints[i].y) - box.y, 0, box.height - 1),
                                std::clamp(cvRound(keypoints[i].x) - box.x, 0, box.width - 1));
    };
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
      const int label = label_at(labels, keypoints[i]);
      if (label == own) {
        features[i].weight = std::max(features[i].weight, high);
      } else if (label == 0 && objects[o].box.contains(keypoints[i])) {
        in_box.push_back(i);
        farthest = std::max(farthest, distance_of(i));
      }
    }
    for (std::size_t i : in_box) {
      features[i].weight = std::max(
          features[i].weight, suspicious_weight(distance_of(i), farthest, share, high, options));
    }
  }
}

}  // namespace dkp_slam
