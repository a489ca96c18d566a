#include "dkp_slam/dynamics/compensation/motion_history.h"

#include <algorithm>

#include "dkp_slam/dynamics/compensation/object_flow.h"
#include "dkp_slam/dynamics/masks/depth_interval.h"

namespace dkp_slam {
namespace {

float depth_seen_at(const DepthView& view, const cv::Point2f& p) {
  return view.depth.at<float>(std::clamp(cvRound(p.y) / DepthView::step, 0, view.depth.rows - 1),
                              std::clamp(cvRound(p.x) / DepthView::step, 0, view.depth.cols - 1));
}

constexpr double packed_per_metre = 4000.0;

/// What was seen before the newest frame is kept to a quarter of a millimetre (a Kinect's depth at
/// one metre is wrong by more than one), in half the memory. Farther than 16 m counts as 16 m.
cv::Mat pack(const cv::Mat& metres) {
  cv::Mat packed;
  metres.convertTo(packed, CV_16U, packed_per_metre);
  return packed;
}

float median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

cv::Point2f centre_of(const cv::Rect2f& box) { return 0.5F * (box.tl() + box.br()); }

}  // namespace

cv::Rect2f moved_box(const cv::Rect2f& box, const cv::Point2f& shift, float depth_before,
                     float depth_now) {
  constexpr float most = 1.25F;  // within a second; more is another surface's depth
  float scale = 1.0F;
  if (depth_before > 0.0F && depth_now > 0.0F) {
    scale = std::clamp(depth_before / depth_now, 1.0F / most, most);
  }
  const cv::Size2f size(scale * box.width, scale * box.height);
  return {centre_of(box) + shift - 0.5F * cv::Point2f(size), size};
}

void MotionHistory::add(double time, const DepthView& view, const std::vector<cv::Point2f>& points,
                        const FlowResult& tracks) {
  Step step;
  step.time = time;
  step.depth = view.depth;
  rays_ = view.rays;
  const DepthView before = steps_.empty() ? view : view_of(steps_.back());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (tracks.tracked[i] == 0) continue;
    step.now.push_back(points[i]);
    step.before.push_back(tracks.previous[i]);
    step.depth_now.push_back(depth_seen_at(view, step.now.back()));
    step.depth_before.push_back(depth_seen_at(before, step.before.back()));
  }
  if (!steps_.empty()) steps_.back().depth = pack(steps_.back().depth);
  steps_.push_back(std::move(step));
  // The step into the oldest moment asked for begins a frame earlier.
  while (steps_.size() > 2 && time - steps_[1].time > seconds_) steps_.pop_front();
}

void MotionHistory::forget_before(double time) {
  // The image of a later moment may have been dropped: the frame before it stands for it.
  while (steps_.size() > 1 && steps_[1].time <= time + same_time) steps_.pop_front();
}

void MotionHistory::set_ego_motion(const Se3& current_from_previous) {
  if (!steps_.empty()) steps_.back().current_from_previous = current_from_previous;
}

DepthView MotionHistory::view_of(const Step& step) const {
  DepthView view;
  view.rays = rays_;
  if (step.depth.type() == CV_32F) {
    view.depth = step.depth;
  } else {
    step.depth.convertTo(view.depth, CV_32F, 1.0 / packed_per_metre);
  }
  return view;
}

/// Median of the nearest layer that fills a good part of the box's middle; 0 when there is none.
float MotionHistory::object_depth(const DepthView& view, const cv::Rect2f& box) const {
  const cv::Rect2f middle(box.x + 0.25F * box.width, box.y + 0.25F * box.height, 0.5F * box.width,
                          0.5F * box.height);
  DepthHistogram histogram;
  std::vector<float> layer;
  for_each_pixel(view_rect(middle, view.depth.size()), [&](int x, int y) {
    if (const float z = view.depth.at<float>(y, x); z > 0.0F) layer.push_back(z);
  });
  for (const float z : layer) histogram.add(z);
  const float mode = dominant_near_mode(histogram, options_.least_layer_share,
                                        2.0 * static_cast<double>(options_.depth_reach));
  std::erase_if(layer, [&](float z) { return std::abs(z - mode) > options_.depth_reach; });
  return mode > 0.0F && !layer.empty() ? median(std::move(layer)) : 0.0F;
}

/// Median flow over one step of what lay in the box at the object's depth, and its depth then.
std::optional<MotionHistory::Motion> MotionHistory::measured(const Step& step,
                                                             const cv::Rect2f& box,
                                                             float depth) const {
  std::vector<cv::Point2f> flow;
  std::vector<float> depths;
  for (std::size_t i = 0; i < step.now.size(); ++i) {
    if (!box.contains(step.before[i])) continue;
    const float z = step.depth_before[i];
    if (depth > 0.0F && std::abs(z - depth) > options_.depth_reach) continue;
    flow.push_back(step.now[i] - step.before[i]);
    const float now = step.depth_now[i];
    if (now > 0.0F && std::abs(now - z) < options_.depth_reach) depths.push_back(now);
  }
  constexpr std::size_t least = 5;  // a median of fewer follows a single wrong match
  if (flow.size() < least) return std::nullopt;
  return Motion{median_flow(std::move(flow)),
                depths.size() < least ? depth : median(std::move(depths))};
}

/// How far something static at a pixel and depth moved in the image over a step.
cv::Point2f MotionHistory::static_shift(const Step& step, const cv::Point2f& centre,
                                        float depth) const {
  if (!step.current_from_previous || depth <= 0.0F) return {};
  const Eigen::Vector2d from(centre.x, centre.y);
  const Eigen::Vector3d point =
      *step.current_from_previous * camera_.unproject(from, static_cast<double>(depth));
  if (point.z() < camera_.min_depth) return {};
  const Eigen::Vector2d moved = camera_.project(point) - from;
  return {static_cast<float>(moved.x()), static_cast<float>(moved.y())};
}

/// Carries over `share` of one step.
void MotionHistory::advance(const Step& before, const Step& step, float share,
                            cv::Point2f& own_velocity, Carried& carried) const {
  const auto seconds = static_cast<float>(step.time - before.time);
  const cv::Point2f with_camera = static_shift(step, centre_of(carried.box), carried.depth);
  Motion motion{with_camera + seconds * own_velocity, carried.depth};
  if (const auto found = measured(step, carried.box, carried.depth)) {
    motion = *found;
    own_velocity = (motion.shift - with_camera) / seconds;
  }
  carried.box = moved_box(carried.box, share * motion.shift, carried.depth, motion.depth);
  carried.shift += share * motion.shift;
  carried.velocity = motion.shift / seconds;
  carried.depth = motion.depth;
}

std::optional<MotionHistory::Carried> MotionHistory::carry(const cv::Rect2f& box,
                                                           const cv::Mat& silhouette,
                                                           double time) const {
  if (steps_.empty() || time < steps_.front().time - same_time) return std::nullopt;
  // The last frame that is not newer than the image, which itself may have been dropped.
  std::size_t from = steps_.size() - 1;
  while (from > 0 && steps_[from].time > time + same_time) --from;
  const DepthView view = view_of(steps_[from]);
  Carried carried;
  carried.box = box;
  if (!silhouette.empty()) {
    carried.mask = mask_from_silhouette(view, silhouette, box);
    carried.depth = carried.mask.mean_depth;
  }
  if (carried.depth <= 0.0F) carried.depth = object_depth(view, box);
  cv::Point2f own_velocity;  // beside what the camera's motion makes of it, pixels a second
  for (std::size_t k = from + 1; k < steps_.size(); ++k) {
    const double length = steps_[k].time - steps_[k - 1].time;
    if (length <= 0.0) continue;
    const double left = std::clamp((steps_[k].time - time) / length, 0.0, 1.0);
    advance(steps_[k - 1], steps_[k], static_cast<float>(left), own_velocity, carried);
  }
  return carried;
}

}  // namespace dkp_slam
