#include "dkp_slam/dynamics/compensation/object_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

/// Fills the convex hull of `mask` in `out`, both CV_8UC1 of one size.
void fill_hull(const cv::Mat& mask, cv::Mat out) {
  std::vector<cv::Point> inside, hull;
  cv::findNonZero(mask, inside);
  if (inside.empty()) return;
  cv::convexHull(inside, hull);
  cv::fillConvexPoly(out, hull, cv::Scalar(255));
}

cv::Rect2f clipped(const cv::Rect2f& box, const cv::Size& image) {
  return box &
         cv::Rect2f(0.0F, 0.0F, static_cast<float>(image.width), static_cast<float>(image.height));
}

/// Box, pixels of the image, around a mask that is not empty.
cv::Rect2f mask_box(const ObjectMask& mask) {
  const cv::Rect r = cv::boundingRect(mask.mask) + mask.area.tl();
  constexpr int step = DepthView::step;
  return cv::Rect2f(cv::Rect(r.x * step, r.y * step, r.width * step, r.height * step));
}

/// Where the object's box was at a time, pixels; nothing when it was not known then.
std::optional<cv::Rect2f> box_at(const ObjectTracker::Tracked& t, double time) {
  if (t.past.empty() || time > t.past.back().time + same_time) return t.object.box;
  if (time < t.past.front().time - same_time) return std::nullopt;
  return std::min_element(t.past.begin(), t.past.end(),
                          [&](const auto& a, const auto& b) {
                            return std::abs(a.time - time) < std::abs(b.time - time);
                          })
      ->box;
}

/// `now` drawn out to the borders of the image that the box lay at before: who comes in goes on
/// beyond what was seen.
cv::Rect2f kept_at_border(const cv::Rect2f& before, const cv::Rect2f& now, const cv::Size& image) {
  constexpr float at = 1.5F;  // pixels
  const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
  cv::Point2f tl = now.tl(), br = now.br();
  if (before.x <= at) tl.x = std::min(tl.x, before.x);
  if (before.y <= at) tl.y = std::min(tl.y, before.y);
  if (before.br().x >= width - at) br.x = std::max(br.x, before.br().x);
  if (before.br().y >= height - at) br.y = std::max(br.y, before.br().y);
  return {tl, br};
}

/// How far an object moved since the frame before, pixels of the view.
cv::Point view_shift(const ObjectTracker::Tracked& t) {
  return {cvRound(t.shift.x / DepthView::step), cvRound(t.shift.y / DepthView::step)};
}

/// The part of a carried object's box that an object of the size last seen can fill.
cv::Rect2f limited(const cv::Rect2f& box, const ObjectTracker::Tracked& t,
                   const ObjectTrackerOptions& options) {
  float growth = options.carried_growth;
  // What has come nearer looks larger.
  if (t.seen_depth > 0.0F && t.object.mean_depth > 0.0F) {
    growth *= std::max(1.0F, t.seen_depth / t.object.mean_depth);
  }
  const cv::Size2f size(growth * t.seen_size.width, growth * t.seen_size.height);
  const cv::Point2f centre = 0.5F * (t.whole_box.tl() + t.whole_box.br());
  return box & cv::Rect2f(centre - 0.5F * cv::Point2f(size), size);
}

}  // namespace

float box_iou(const cv::Rect2f& a, const cv::Rect2f& b) {
  const float common = (a & b).area();
  const float all = a.area() + b.area() - common;
  return all > 0.0F ? common / all : 0.0F;
}

void ObjectTracker::predict(double time, const cv::Size& image,
                            const std::vector<std::optional<cv::Point2f>>& flow) {
  const double dt = objects_.empty() ? 0.0 : time - last_time_;
  const auto seconds = static_cast<float>(dt);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Tracked& t = objects_[i];
    t.past.push_back({last_time_, t.object.box});
    while (time - t.past.front().time > options_.longest_delay + dt) t.past.pop_front();
    if (i < flow.size() && flow[i] && dt > 0.0) t.velocity = *flow[i] / seconds;
    t.shift = t.velocity * seconds;
    t.whole_box += t.shift;
    t.object.box = clipped(t.whole_box, image);
    t.object.compensated = true;
    t.silhouette.release();
  }
  passed_ = time - last_time_;
  last_time_ = time;
}

/// Pairs of object and detection that agree at the image's time, the best first.
std::vector<ObjectTracker::Pair> ObjectTracker::agreements(const std::vector<Sighting>& sightings,
                                                           double image_time) const {
  std::vector<Pair> pairs;
  for (std::size_t o = 0; o < objects_.size(); ++o) {
    const std::optional<cv::Rect2f> box_then = box_at(objects_[o], image_time);
    for (std::size_t d = 0; d < sightings.size(); ++d) {
      const Detection& detection = *sightings[d].detection;
      const int known_class = objects_[o].object.class_id;
      // What was only seen to move takes the name of the first detection that fits.
      const bool same =
          detection.class_id == known_class || (known_class == Detection::motion_class &&
                                                detection.weight >= options_.self_moving_weight);
      if (detection.weight <= 1.0F || !same) continue;
      const bool weak_is_enough =
          options_.compensate && detection.weight >= options_.self_moving_weight;
      const float needed = weak_is_enough ? options_.continue_score : options_.start_score;
      if (detection.score < needed) continue;
      const float iou = box_then ? box_iou(*box_then, detection.box)
                                 : box_iou(objects_[o].object.box, sightings[d].now.box);
      if (iou > options_.continue_iou) pairs.emplace_back(iou, o, d);
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
    return std::get<0>(a) != std::get<0>(b) ? std::get<0>(a) > std::get<0>(b) : a < b;
  });
  return pairs;
}

/// Gives an object its detection, which is now at `box`.
void ObjectTracker::take(const Detection& d, const cv::Rect2f& box, double image_time,
                         const cv::Size& image, Tracked& t) const {
  t.object.box = clipped(box, image);
  t.whole_box = box;
  t.object.class_id = d.class_id;
  t.object.weight = d.weight;
  t.object.moves_by_itself = d.weight >= options_.self_moving_weight;
  t.object.score = d.score;
  t.object.compensated = false;
  t.object.last_detected = image_time;
  t.last_confirmed = std::max(t.last_confirmed, image_time);
  t.missed = false;
  ++t.sightings;
  t.detected_box = d.box;
  t.seen_size = box.size();
  t.seen_depth = 0.0F;
}

/// A late detection's box together with where the object's mask went, as far as an object of that
/// size can reach: the carried box drifts, and the mask of the frame before does not. A mask that
/// is mostly another object's says nothing: who stands in front was cut in place of who is behind.
cv::Rect2f ObjectTracker::with_mask(const cv::Rect2f& box, const Tracked& t) const {
  if (t.mask.empty()) return box;
  const int area = cv::countNonZero(t.mask.mask);
  for (const Tracked& other : objects_) {
    if (&other != &t && 2 * mask_overlap(t.mask, other.mask) > area) return box;
  }
  const cv::Size2f size(options_.carried_growth * box.width, options_.carried_growth * box.height);
  const cv::Point2f centre = 0.5F * (box.tl() + box.br());
  const cv::Rect2f reach(centre - 0.5F * cv::Point2f(size), size);
  const cv::Rect2f seen = (mask_box(t.mask) + t.shift) & reach;
  return seen.area() > 0.0F ? box | seen : box;
}

void ObjectTracker::associate(const std::vector<Sighting>& sightings, double image_time,
                              const cv::Size& image) {
  const bool late = last_time_ - image_time > same_time;
  std::vector<bool> object_taken(objects_.size(), false);
  std::vector<bool> detection_taken(sightings.size(), false);
  for (const auto& [iou, o, d] : agreements(sightings, image_time)) {
    if (object_taken[o] || detection_taken[d]) continue;
    object_taken[o] = detection_taken[d] = true;
    Tracked& t = objects_[o];
    const Detection& detection = *sightings[d].detection;
    cv::Rect2f box = sightings[d].now.box;
    if (late) box = with_mask(kept_at_border(detection.box, box, image), t);
    take(detection, box, image_time, image, t);
    t.seen_size = sightings[d].now.box.size();
    if (!late) t.silhouette = detection.mask;
  }
  for (std::size_t o = 0; o < objects_.size(); ++o) {
    if (!object_taken[o]) objects_[o].missed = true;
  }
  for (std::size_t d = 0; d < sightings.size(); ++d) {
    const Detection& detection = *sightings[d].detection;
    if (detection_taken[d] || detection.weight <= 1.0F) continue;
    if (detection.score < options_.start_score || detection.box.area() <= 0.0F) continue;
    Tracked fresh;
    const MotionHistory::Carried& now = sightings[d].now;
    const cv::Rect2f box = late ? kept_at_border(detection.box, now.box, image) : detection.box;
    take(detection, box, image_time, image, fresh);
    if (late && leaving(fresh)) continue;
    fresh.object.id = next_id_++;
    if (late) {
      fresh.mask = now.mask;
      fresh.shift = now.shift;
      fresh.velocity = now.velocity;
      fresh.object.mean_depth = now.depth;
    } else {
      fresh.silhouette = detection.mask;
    }
    objects_.push_back(std::move(fresh));
  }
}

void ObjectTracker::update(double time, const cv::Size& image, const DetectionResult& answer,
                           const std::vector<std::optional<cv::Point2f>>& flow,
                           const MotionHistory* history) {
  predict(time, image, flow);
  const bool fresh = answer.answered && answer.timestamp > last_answer_;
  if (fresh) last_answer_ = answer.timestamp;
  // A detector that runs ahead of the tracker may know an image that is still to come.
  const double image_time = std::min(answer.timestamp, time);
  if (fresh && time - image_time <= options_.longest_delay) {
    std::vector<Sighting> sightings;
    for (const Detection& d : answer.detections) {
      Sighting sighting{&d, {}};
      sighting.now.box = d.box;
      if (history && time - image_time > same_time) {
        if (const auto carried = history->carry(d.box, d.mask, image_time)) sighting.now = *carried;
      }
      sightings.push_back(std::move(sighting));
    }
    associate(sightings, image_time, image);
  }
  drop_gone();
}

void ObjectTracker::drop_gone() {
  dropped_by_a_miss_ = 0;
  std::vector<bool> gone;
  gone.reserve(objects_.size());
  for (const Tracked& t : objects_) {
    gone.push_back(is_gone(t));
    dropped_by_a_miss_ += gone.back() && t.object.moves_by_itself && !carries() && !leaving(t);
  }
  remove(gone);
}

bool ObjectTracker::leaving(const Tracked& t) const {
  return t.object.box.area() < options_.leaving_share * t.whole_box.area();
}

bool ObjectTracker::is_gone(const Tracked& t) const {
  if (!t.object.compensated) return false;
  if (t.missed && (!options_.compensate || !t.object.moves_by_itself)) return true;
  if (last_time_ - t.last_confirmed > options_.carry_seconds || leaving(t)) return true;
  return std::any_of(objects_.begin(), objects_.end(), [&](const Tracked& other) {
    return !other.object.compensated && other.object.class_id == t.object.class_id &&
           (other.object.box & t.object.box).area() >
               options_.duplicate_share * t.object.box.area();
  });
}

std::vector<cv::Rect2f> ObjectTracker::self_moving_boxes() const {
  std::vector<cv::Rect2f> boxes;
  for (const Tracked& t : objects_) {
    if (t.object.moves_by_itself) boxes.push_back(t.object.box);
  }
  return boxes;
}

ObjectTracker::Cover ObjectTracker::cover(const cv::Size& view_size) const {
  cv::Mat boxes = cv::Mat::zeros(view_size, CV_8UC1);
  cv::Mat silhouettes = boxes.clone();
  std::vector<std::pair<cv::Rect, cv::Mat>> shown;
  bool any = false;
  for (const Tracked& t : objects_) {
    if (!t.object.moves_by_itself) continue;
    any = true;
    boxes(view_rect(t.object.box, view_size)) = 255;
    const cv::Point shift = view_shift(t);
    const cv::Rect to = (t.mask.area + shift) & cv::Rect({0, 0}, view_size);
    if (t.mask.empty() || to.area() == 0) continue;
    const cv::Mat mask = t.mask.mask(to - shift - t.mask.area.tl());
    silhouettes(to).setTo(255, mask);
    shown.emplace_back(to, mask);
  }
  if (!any) return {};
  boxes |= silhouettes;
  constexpr double most = 0.75;  // of the image
  const bool too_much = cv::countNonZero(boxes) > most * static_cast<double>(boxes.total());
  // Over a gap people have moved out of their silhouettes, and two backs make a plane.
  constexpr double gap = 0.1;  // seconds
  const bool known = passed_ < gap && cv::countNonZero(silhouettes) > 0;
  if (!too_much || !known) return {boxes, {}};
  cv::Mat hulls = cv::Mat::zeros(view_size, CV_8UC1);
  for (const auto& [area, mask] : shown) fill_hull(mask, hulls(area));
  return {silhouettes, hulls};
}

ObjectPrior ObjectTracker::prior_of(const Tracked& t) {
  ObjectPrior prior;
  prior.mean_depth = t.object.mean_depth;
  prior.share = t.object.mask_share;
  prior.mask = t.mask;
  prior.shift = view_shift(t);
  prior.named = t.object.named();
  prior.carried = t.object.compensated && !t.mask.empty();
  return prior;
}

void ObjectTracker::set_mask(std::size_t index, const ObjectMask& mask, bool moving) {
  Tracked& t = objects_[index];
  t.mask = mask;
  t.object.mean_depth = mask.mean_depth;
  t.object.mask_share = mask.share;
  if (mask.empty()) return;
  if (!t.object.compensated) t.seen_depth = mask.mean_depth;
  if (moving) t.last_confirmed = last_time_;
  if (t.object.compensated) t.object.box = t.whole_box = limited(mask_box(mask), t, options_);
}

void ObjectTracker::add_moving(const ObjectMask& mask) {
  Tracked fresh;
  fresh.object.id = next_id_++;
  fresh.object.class_id = Detection::motion_class;
  fresh.object.box = fresh.whole_box = mask_box(mask);
  fresh.object.last_detected = fresh.last_confirmed = last_time_;
  fresh.missed = true;
  fresh.object.mean_depth = mask.mean_depth;
  fresh.object.mask_share = mask.share;
  fresh.mask = mask;
  fresh.seen_size = fresh.whole_box.size();
  fresh.seen_depth = mask.mean_depth;
  objects_.push_back(std::move(fresh));
}

/// Whether a carried object that was hardly seen, and now is missed, was the detector's mistake
/// about the other one: a box as large as the image, in place of the person in it whom the next
/// image shows.
bool ObjectTracker::mistaken_for(const Tracked& t, const Tracked& other) const {
  // What was only seen to move is nobody's mistake.
  if (t.sightings < 1 || t.sightings > options_.few_sightings) return false;
  if (!t.missed || other.object.compensated || other.object.class_id != t.object.class_id)
    return false;
  return other.object.score > t.object.score && !other.mask.empty() &&
         2 * mask_overlap(other.mask, t.mask) > cv::countNonZero(other.mask.mask);
}

void ObjectTracker::drop_duplicates() {
  std::vector<bool> gone(objects_.size(), false);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Tracked& t = objects_[i];
    const int area = t.mask.empty() ? 0 : cv::countNonZero(t.mask.mask);
    if (area == 0 || !t.object.compensated) continue;
    for (std::size_t j = 0; j < objects_.size() && !gone[i]; ++j) {
      const Tracked& other = objects_[j];
      // Of two carried ones the older stays.
      const bool stronger = !other.object.compensated || other.object.id < t.object.id;
      // A mask reaches out of its box over whoever stands beside: that one is not the same.
      const bool same_place = 2.0F * (other.object.box & t.object.box).area() > t.object.box.area();
      const bool same = stronger && same_place && 2 * mask_overlap(t.mask, other.mask) > area;
      gone[i] = j != i && !gone[j] && (same || mistaken_for(t, other));
    }
  }
  remove(gone);
}

void ObjectTracker::remove(const std::vector<bool>& gone) {
  std::vector<Tracked> kept;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (!gone[i]) kept.push_back(std::move(objects_[i]));
  }
  objects_ = std::move(kept);
}

}  // namespace dkp_slam
