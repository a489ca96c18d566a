#include "dkp_slam/dynamics/dynamics_module.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>

#include "dkp_slam/dynamics/depth_view.h"
#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

class Stopwatch {
 public:
  /// Milliseconds since the last lap.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double, std::milli> passed = now - last_;
    last_ = now;
    return passed.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

template <typename T>
T value_at(const cv::Mat& image, const cv::Point2f& p) {
  const int x = std::clamp(cvRound(p.x), 0, image.cols - 1);
  const int y = std::clamp(cvRound(p.y), 0, image.rows - 1);
  return image.at<T>(y, x);
}

float median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

struct DynamicsModule::State {
  State(const Camera& c, const DynamicsOptions& o)
      : camera(c), options(o), rays(depth_view_rays(c)), flow(o.flow), tracker(o.compensation) {}

  Camera camera;
  DynamicsOptions options;
  cv::Mat rays;
  BackwardFlow flow;
  BoxTracker tracker;
  cv::Mat previous_labels;  // CV_8UC1: i + 1 in the mask of the tracker's object i, earlier frame
  Se3 previous_motion;      // start of the next motion estimate
  std::uint64_t frame_seed = 0;

  std::vector<std::optional<cv::Point2f>> object_flow(const std::vector<cv::Point2f>& points,
                                                      const FlowResult& tracks) const;
  cv::Mat cut_masks(const RgbdFrame& frame);
  void measure(const RgbdFrame& frame, const std::vector<cv::Point2f>& points,
               const FlowResult& tracks, std::vector<FeatureDynamics>& features);
};

/// Median flow of the dynamic points of each tracked object (paper §3.3).
std::vector<std::optional<cv::Point2f>> DynamicsModule::State::object_flow(
    const std::vector<cv::Point2f>& points, const FlowResult& tracks) const {
  const std::size_t n = tracker.objects().size();
  std::vector<std::vector<float>> dx(n), dy(n);
  for (std::size_t i = 0; i < points.size() && !previous_labels.empty(); ++i) {
    if (tracks.tracked[i] == 0) continue;
    const std::size_t label = value_at<std::uint8_t>(previous_labels, tracks.previous[i]);
    if (label == 0 || label > n) continue;
    dx[label - 1].push_back(points[i].x - tracks.previous[i].x);
    dy[label - 1].push_back(points[i].y - tracks.previous[i].y);
  }
  std::vector<std::optional<cv::Point2f>> result(n);
  constexpr std::size_t min_points = 5;  // a median of fewer follows a single wrong match
  for (std::size_t o = 0; o < n; ++o) {
    if (dx[o].size() >= min_points) result[o] = cv::Point2f(median(dx[o]), median(dy[o]));
  }
  return result;
}

/// Cuts every object's mask; returns the labels, CV_8UC1 of the image's size.
cv::Mat DynamicsModule::State::cut_masks(const RgbdFrame& frame) {
  cv::Mat labels = cv::Mat::zeros(frame.depth.size(), CV_8UC1);
  if (tracker.objects().empty()) return labels;
  const DepthView view = make_depth_view(frame.depth, rays);
  cv::Mat planes;
  if (options.clustering.remove_planes && options.clustering.mode != ClusteringMode::paper) {
    cv::Mat boxes = cv::Mat::zeros(view.depth.size(), CV_8UC1);
    cv::Rect area;
    for (const auto& t : tracker.objects()) {
      const cv::Rect box = view_rect(t.object.box, view.depth.size());
      boxes(box) = 255;
      area |= box;
    }
    const int margin = std::max(area.width, area.height) / 4;
    area = cv::Rect(area.x - margin, area.y - margin, area.width + 2 * margin,
                    area.height + 2 * margin);
    planes = plane_pixels(view, fit_planes(view, boxes, options.clustering.planes, frame_seed),
                          area, options.clustering.planes);
  }
  struct Cut {
    std::size_t object;
    ObjectMask mask;
  };
  std::vector<Cut> cuts;
  std::vector<bool> gone(tracker.objects().size(), false);
  for (std::size_t o = 0; o < tracker.objects().size(); ++o) {
    const auto& t = tracker.objects()[o];
    const ObjectPrior prior{t.object.mean_depth, t.object.mask_share};
    ObjectMask mask =
        cluster_object(view, planes, t.object.box, prior, options.clustering, frame_seed);
    tracker.set_mask_result(o, mask.mean_depth, mask.share);
    gone[o] = mask.empty() && t.object.compensated;
    if (!gone[o]) cuts.push_back({o, std::move(mask)});
  }
  tracker.remove(gone);
  std::vector<std::size_t> order(cuts.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  // Far ones first, so that the near ones lie on top.
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cuts[a].mask.mean_depth > cuts[b].mask.mean_depth;
  });
  for (const std::size_t i : order) {
    if (cuts[i].mask.empty()) continue;
    paint_object(cuts[i].mask, static_cast<std::uint8_t>(i + 1), labels);
  }
  return labels;
}

/// Fills tracked, D and the motion residual of every feature.
void DynamicsModule::State::measure(const RgbdFrame& frame, const std::vector<cv::Point2f>& points,
                                    const FlowResult& tracks,
                                    std::vector<FeatureDynamics>& features) {
  const std::vector<cv::Point2f> now = camera.undistort(points);
  const std::vector<cv::Point2f> then = camera.undistort(tracks.previous);
  PointMatches matches;
  std::vector<MotionPoint> observations(points.size());
  std::vector<bool> has_depth(points.size(), false);
  std::vector<MotionPoint> low_points, all_points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    features[i].tracked = tracks.tracked[i] != 0;
    if (!features[i].tracked) continue;
    const bool low = features[i].region == Region::low;
    matches.current.push_back(now[i]);
    matches.previous.push_back(then[i]);
    matches.low.push_back(low ? 1 : 0);
    const float z = value_at<float>(frame.depth, points[i]);
    observations[i].previous = {then[i].x, then[i].y};
    if (z <= 0.0F) continue;
    has_depth[i] = true;
    observations[i].point = camera.unproject({now[i].x, now[i].y}, z);
    all_points.push_back(observations[i]);
    if (low) low_points.push_back(observations[i]);
  }
  const auto fundamental = estimate_fundamental(matches, options.epipolar);
  if (fundamental) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!features[i].tracked) continue;
      features[i].epipolar_distance =
          static_cast<float>(epipolar_distance(*fundamental, then[i], now[i]));
    }
  }
  if (options.mode != DynamicsMode::dkp_plus) return;
  const bool enough = static_cast<int>(low_points.size()) >= options.epipolar.min_low_matches;
  const auto motion = estimate_motion(camera, enough ? low_points : all_points, previous_motion,
                                      options.motion, frame_seed);
  previous_motion = motion ? motion->previous_from_current : Se3();
  if (!motion) return;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!features[i].tracked) continue;
    features[i].motion_residual = static_cast<float>(
        has_depth[i]
            ? motion_residual(camera, motion->previous_from_current, observations[i])
            : motion_residual_without_depth(camera, motion->previous_from_current,
                                            {now[i].x, now[i].y}, observations[i].previous,
                                            camera.min_depth));
  }
}

DynamicsModule::DynamicsModule(const Camera& camera, const DynamicsOptions& options) {
  if (const auto wrong = camera.check()) {
    throw Error("dynamics: camera '" + camera.name + "': " + *wrong);
  }
  state_ = std::make_unique<State>(camera, options);
}
DynamicsModule::~DynamicsModule() = default;
DynamicsModule::DynamicsModule(DynamicsModule&&) noexcept = default;
DynamicsModule& DynamicsModule::operator=(DynamicsModule&&) noexcept = default;

FrameDynamics DynamicsModule::process(const RgbdFrame& frame, const cv::Mat& grey,
                                      const std::vector<cv::KeyPoint>& keypoints,
                                      const std::vector<Detection>& detections) {
  State& s = *state_;
  const cv::Size size(s.camera.width, s.camera.height);
  if (grey.size() != size || grey.type() != CV_8UC1 || frame.depth.size() != size ||
      frame.depth.type() != CV_32FC1) {
    throw Error("dynamics: frame " + std::to_string(frame.index) +
                " needs grey (8 bit) and depth (float) images of the camera's " +
                std::to_string(size.width) + " x " + std::to_string(size.height) + " pixels");
  }
  FrameDynamics result;
  result.features.resize(keypoints.size());
  if (s.options.mode == DynamicsMode::off) return result;
  s.frame_seed = s.options.seed + static_cast<std::uint64_t>(frame.index) * 0x9E3779B97F4A7C15ULL;

  Stopwatch watch;
  std::vector<cv::Point2f> points;
  cv::KeyPoint::convert(keypoints, points);
  s.flow.push(grey);
  FlowResult tracks;
  tracks.previous = points;
  tracks.tracked.assign(points.size(), 0);
  if (s.flow.earlier_frames() > 0) tracks = s.flow.track(points, 1, {});
  result.removal_ms += watch.lap();

  s.tracker.update(frame.timestamp, size, detections, s.object_flow(points, tracks));
  const cv::Mat labels = s.cut_masks(frame);
  s.previous_labels = labels;
  std::vector<ObjectRegions> regions;
  for (const auto& t : s.tracker.objects()) {
    result.objects.push_back(t.object);
    regions.push_back({t.object.box, t.object.weight});
  }
  if (!result.objects.empty()) result.mask = labels > 0;
  result.clustering_ms = watch.lap();

  assign_regions(points, regions, labels, s.options.regions, result.features);
  std::vector<FeatureEvidence> evidence(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto label = value_at<std::uint8_t>(labels, points[i]);
    for (std::size_t o = 0; o < regions.size(); ++o) {
      const bool belongs = label > 0 ? label == o + 1 : regions[o].box.contains(points[i]);
      if (belongs) evidence[i].object_weight = std::max(evidence[i].object_weight, regions[o].weight);
    }
  }
  s.measure(frame, points, tracks, result.features);
  classify(s.options.mode, s.options.removal, evidence, result.features);
  result.removal_ms += watch.lap();
  return result;
}

}  // namespace dkp_slam
