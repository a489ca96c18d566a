#include "dkp_slam/dynamics/box_tracker.h"

#include <algorithm>
#include <tuple>

namespace dkp_slam {
namespace {

cv::Rect2f clipped(const cv::Rect2f& box, const cv::Size& image) {
  return box & cv::Rect2f(0.0F, 0.0F, static_cast<float>(image.width),
                          static_cast<float>(image.height));
}

}  // namespace

float box_iou(const cv::Rect2f& a, const cv::Rect2f& b) {
  const float common = (a & b).area();
  const float all = a.area() + b.area() - common;
  return all > 0.0F ? common / all : 0.0F;
}

void BoxTracker::predict(double dt, const cv::Size& image,
                         const std::vector<std::optional<cv::Point2f>>& flow) {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Tracked& t = objects_[i];
    const auto seconds = static_cast<float>(dt);
    if (i < flow.size() && flow[i] && dt > 0.0) t.velocity = *flow[i] / seconds;
    t.whole_box += t.velocity * seconds;
    t.object.box = clipped(t.whole_box, image);
    t.object.compensated = true;
    t.silhouette.release();
  }
}

void BoxTracker::update(double time, const cv::Size& image,
                        const std::vector<Detection>& detections,
                        const std::vector<std::optional<cv::Point2f>>& flow) {
  predict(objects_.empty() ? 0.0 : time - last_time_, image, flow);
  last_time_ = time;

  // Known objects take their detections first, the best agreement first.
  std::vector<std::tuple<float, std::size_t, std::size_t>> pairs;
  for (std::size_t o = 0; o < objects_.size(); ++o) {
    for (std::size_t d = 0; d < detections.size(); ++d) {
      const Detection& detection = detections[d];
      if (detection.weight <= 1.0F || detection.class_id != objects_[o].object.class_id) continue;
      const float needed = options_.compensate ? options_.continue_score : options_.start_score;
      if (detection.score < needed) continue;
      const float iou = box_iou(objects_[o].object.box, detection.box);
      if (iou > options_.continue_iou) pairs.emplace_back(iou, o, d);
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
    return std::get<0>(a) != std::get<0>(b) ? std::get<0>(a) > std::get<0>(b) : a < b;
  });
  std::vector<bool> object_taken(objects_.size(), false);
  std::vector<bool> detection_taken(detections.size(), false);
  const auto take = [&](Tracked& t, const Detection& d) {
    t.object.box = clipped(d.box, image);
    t.whole_box = d.box;
    t.object.weight = d.weight;
    t.object.score = d.score;
    t.object.compensated = false;
    t.object.last_detected = time;
    t.silhouette = d.mask;
    t.detected_box = d.box;
  };
  for (const auto& [iou, o, d] : pairs) {
    if (object_taken[o] || detection_taken[d]) continue;
    object_taken[o] = detection_taken[d] = true;
    take(objects_[o], detections[d]);
  }
  for (std::size_t d = 0; d < detections.size(); ++d) {
    if (detection_taken[d] || detections[d].weight <= 1.0F) continue;
    if (detections[d].score < options_.start_score || detections[d].box.area() <= 0.0F) continue;
    Tracked fresh;
    fresh.object.id = next_id_++;
    fresh.object.class_id = detections[d].class_id;
    take(fresh, detections[d]);
    objects_.push_back(std::move(fresh));
  }

  const auto gone = [&](const Tracked& t) {
    if (!t.object.compensated) return false;
    if (!options_.compensate || time - t.object.last_detected > options_.carry_seconds) return true;
    if (t.object.box.area() < options_.leaving_share * t.whole_box.area()) return true;
    return std::any_of(objects_.begin(), objects_.end(), [&](const Tracked& other) {
      return !other.object.compensated && other.object.class_id == t.object.class_id &&
             (other.object.box & t.object.box).area() >
                 options_.duplicate_share * t.object.box.area();
    });
  };
  std::vector<bool> flags;
  flags.reserve(objects_.size());
  for (const Tracked& t : objects_) flags.push_back(gone(t));
  remove(flags);
}

void BoxTracker::set_mask_result(std::size_t index, float mean_depth, float mask_share) {
  objects_[index].object.mean_depth = mean_depth;
  objects_[index].object.mask_share = mask_share;
}

void BoxTracker::remove(const std::vector<bool>& gone) {
  std::vector<Tracked> kept;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (!gone[i]) kept.push_back(std::move(objects_[i]));
  }
  objects_ = std::move(kept);
}

}  // namespace dkp_slam
