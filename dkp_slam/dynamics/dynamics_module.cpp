#include "dkp_slam/dynamics/dynamics_module.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/dynamics/masks/depth_view.h"
#include "dkp_slam/error.h"
#include "dkp_slam/stopwatch.h"

namespace dkp_slam {
namespace {

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
      : camera(c),
        options(o),
        rays(depth_view_rays(c)),
        motion(c, o.motion),
        tracker(o.compensation),
        room(o.room, o.clustering.planes) {}

  Camera camera;
  DynamicsOptions options;
  cv::Mat rays;
  FeatureMotionEstimator motion;
  BoxTracker tracker;
  RoomPlanes room;
  cv::Mat previous_labels;  // CV_8UC1: i + 1 in the mask of the tracker's object i, earlier frame
  /// A surface outside all objects that moves, and since when.
  struct Suspect {
    ObjectMask mask;
    double since = 0.0;
  };
  std::vector<Suspect> suspects;
  std::uint64_t frame_seed = 0;

  bool certain(const BoxTracker::Tracked& t) const {
    return t.object.weight >= options.removal.certain_weight;
  }
  std::vector<std::optional<cv::Point2f>> object_flow(const std::vector<cv::Point2f>& points,
                                                      const FlowResult& tracks) const;
  std::vector<std::uint8_t> outside_boxes(const std::vector<cv::Point2f>& points) const;
  void add_room_points(const DepthView& view, const std::vector<cv::Point2f>& points,
                       std::vector<std::uint8_t>& low);
  void judge_surfaces(const std::vector<cv::Point2f>& points, const FeatureMotion& found,
                      Scene& scene) const;
  std::optional<Scene> build_scene(const RgbdFrame& frame, const DepthView& view,
                                   const FeatureMotion& found);
  cv::Mat cut_masks(Scene& scene, double timestamp, const std::vector<cv::Point2f>& points,
                    const FeatureMotion& found);
  std::vector<FeatureEvidence> collect_evidence(const std::vector<cv::Point2f>& points,
                                                const std::vector<ObjectRegions>& regions,
                                                const cv::Mat& labels, const cv::Mat& mask,
                                                const std::vector<float>& long_residual) const;
  bool cut_object(const Scene& scene, std::size_t index);
  cv::Mat people_cover() const;
  void add_moving_surfaces(const Scene& scene, double now);
  void measure_epipolar(const FeatureMotion& found, std::vector<FeatureDynamics>& features) const;
};

/// Fills D of Eq. 5.
void DynamicsModule::State::measure_epipolar(const FeatureMotion& found,
                                             std::vector<FeatureDynamics>& features) const {
  PointMatches matches;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!features[i].tracked) continue;
    matches.current.push_back(found.now[i]);
    matches.previous.push_back(found.then[i]);
    matches.low.push_back(features[i].region == Region::low ? 1 : 0);
  }
  const auto fundamental = estimate_fundamental(matches, options.epipolar);
  if (!fundamental) return;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!features[i].tracked) continue;
    features[i].epipolar_distance =
        static_cast<float>(epipolar_distance(*fundamental, found.then[i], found.now[i]));
  }
}

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

/// 1 for points outside the boxes of all objects that move by themselves.
std::vector<std::uint8_t> DynamicsModule::State::outside_boxes(
    const std::vector<cv::Point2f>& points) const {
  std::vector<std::uint8_t> outside(points.size(), 1);
  for (const auto& t : tracker.objects()) {
    if (!certain(t)) continue;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (t.object.box.contains(points[i])) outside[i] = 0;
    }
  }
  return outside;
}

/// Where boxes leave too few points for the camera's motion: those in boxes that lie on a plane of
/// the room, as far as the camera's earlier motion tells where it is now.
void DynamicsModule::State::add_room_points(const DepthView& view,
                                            const std::vector<cv::Point2f>& points,
                                            std::vector<std::uint8_t>& low) {
  if (std::count(low.begin(), low.end(), 1) >= options.removal.enough_outside) return;
  const std::vector<Plane> planes = room.planes();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point at(std::clamp(cvRound(points[i].x) / DepthView::step, 0, view.depth.cols - 1),
                       std::clamp(cvRound(points[i].y) / DepthView::step, 0, view.depth.rows - 1));
    for (const Plane& plane : planes) {
      if (low[i] == 0 && runs_along(view, plane, at.x, at.y, options.clustering.planes)) low[i] = 1;
    }
  }
}

/// Counts moving and still features on every surface.
void DynamicsModule::State::judge_surfaces(const std::vector<cv::Point2f>& points,
                                           const FeatureMotion& found, Scene& scene) const {
  const RemovalOptions& r = options.removal;
  // A shaking camera makes everything less certain: thresholds follow the static points' own noise.
  const auto noise = static_cast<float>(found.camera_motion ? found.camera_motion->noise : 0.0);
  const float moving_short = std::max(r.moving_short, r.noise_factor * noise);
  const float moving_long = std::max(r.moving_long, r.noise_factor * noise);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float brief = found.residual[i], lengthy = found.long_residual[i];
    const bool moves = brief > moving_short || lengthy > moving_long;
    const bool rests = !moves && lengthy < r.still_long;
    if (!moves && !rests) continue;
    const int index = segment_near(scene.surfaces, cvRound(points[i].x) / DepthView::step,
                                   cvRound(points[i].y) / DepthView::step);
    if (index < 0) continue;
    Segment& segment = scene.surfaces.segments[static_cast<std::size_t>(index)];
    ++(moves ? segment.moving : segment.still);
  }
}

/// Cuts one object's mask; false when a carried object is not to be found any more.
bool DynamicsModule::State::cut_object(const Scene& scene, std::size_t index) {
  const auto& t = tracker.objects()[index];
  if (!certain(t)) return true;
  if (!t.silhouette.empty()) {
    tracker.set_mask(index, mask_from_silhouette(scene.view, t.silhouette, t.detected_box), true);
    return true;
  }
  ObjectPrior prior;
  prior.mean_depth = t.object.mean_depth;
  prior.share = t.object.mask_share;
  prior.mask = t.mask;
  prior.shift = {cvRound(t.shift.x / DepthView::step), cvRound(t.shift.y / DepthView::step)};
  prior.carried = t.object.compensated && !t.mask.empty();
  const ObjectMask mask =
      cluster_object(scene, t.object.box, prior, options.clustering, frame_seed);
  tracker.set_mask(index, mask, mask.moving);
  return !t.object.compensated || !(mask.empty() || mask.still);
}

/// People whom no detector sees: surfaces proved to move that no object holds yet.
void DynamicsModule::State::add_moving_surfaces(const Scene& scene, double now) {
  const SegmentMap& surfaces = scene.surfaces;
  std::vector<Suspect> still_suspect;
  const double needed =
      options.removal.moving_surface_share * static_cast<double>(surfaces.labels.total());
  // When half of what is seen seems to move, it is the camera's motion that is wrong.
  const double most = 0.5 * static_cast<double>(surfaces.labels.total());
  for (std::size_t i = 0; i < surfaces.segments.size(); ++i) {
    const Segment& s = surfaces.segments[i];
    if (!s.proved_moving() || s.moving < options.removal.moving_surface_points) continue;
    if (s.area < needed || s.area > most || s.flat) continue;
    ObjectMask mask;
    mask.area = s.box;
    mask.mask = surfaces.labels(s.box) == static_cast<int>(i) + 1;
    mask.mean_depth = s.mean_depth;
    mask.share = static_cast<float>(s.area) / static_cast<float>(s.box.area());
    int held = 0;
    for (const auto& t : tracker.objects()) held = std::max(held, mask_overlap(mask, t.mask));
    if (2 * held >= s.area) continue;
    const auto known = std::find_if(suspects.begin(), suspects.end(), [&](const Suspect& before) {
      return 2 * mask_overlap(mask, before.mask) > s.area;
    });
    Suspect suspect{mask, known == suspects.end() ? now : known->since};
    if (now - suspect.since >= options.removal.moving_surface_seconds) {
      tracker.add_moving(mask);
    } else {
      still_suspect.push_back(std::move(suspect));
    }
  }
  suspects = std::move(still_suspect);
}

/// Where planes must not be looked for, CV_8UC1 of the view's size: the people's boxes, or only
/// their earlier silhouettes moved along when the boxes leave too little. Empty when there are no
/// people.
cv::Mat DynamicsModule::State::people_cover() const {
  cv::Mat boxes = cv::Mat::zeros(rays.size(), CV_8UC1), silhouettes = boxes.clone();
  bool people = false;
  for (const auto& t : tracker.objects()) {
    if (!certain(t)) continue;
    people = true;
    boxes(view_rect(t.object.box, rays.size())) = 255;
    const cv::Point shift(cvRound(t.shift.x / DepthView::step),
                          cvRound(t.shift.y / DepthView::step));
    const cv::Rect to = (t.mask.area + shift) & cv::Rect(0, 0, boxes.cols, boxes.rows);
    if (t.mask.empty() || to.area() == 0) continue;
    silhouettes(to).setTo(255, t.mask.mask(to - shift - t.mask.area.tl()));
  }
  if (!people) return {};
  boxes |= silhouettes;
  constexpr double most = 0.75;  // of the image
  const bool too_much = cv::countNonZero(boxes) > most * static_cast<double>(boxes.total());
  return too_much && cv::countNonZero(silhouettes) > 0 ? silhouettes : boxes;
}

/// The surroundings for cutting masks out; none when there is nobody to cut out.
std::optional<Scene> DynamicsModule::State::build_scene(const RgbdFrame& frame,
                                                        const DepthView& view,
                                                        const FeatureMotion& found) {
  cv::Mat covered = people_cover();
  const bool people = !covered.empty();
  if (!people) covered = cv::Mat::zeros(rays.size(), CV_8UC1);
  const auto movers = std::count_if(found.residual.begin(), found.residual.end(),
                                    [&](float r) { return r > options.removal.moving_short; });
  const bool with_motion = options.mode == DynamicsMode::dkp_plus;
  if (!people && (!with_motion || movers < options.removal.moving_surface_points)) {
    return std::nullopt;
  }
  room.update(view, fit_planes(view, covered, options.clustering.planes, frame_seed),
              frame.timestamp);
  return make_scene(view, camera.fx, room.planes(), options.clustering, frame_seed);
}

/// Cuts every object's mask; returns the labels, CV_8UC1 of the image's size.
cv::Mat DynamicsModule::State::cut_masks(Scene& scene, double timestamp,
                                         const std::vector<cv::Point2f>& points,
                                         const FeatureMotion& found) {
  cv::Mat labels = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
  const bool with_motion = options.mode == DynamicsMode::dkp_plus;
  if (with_motion) judge_surfaces(points, found, scene);
  std::vector<bool> gone(tracker.objects().size(), false);
  for (std::size_t o = 0; o < gone.size(); ++o) gone[o] = !cut_object(scene, o);
  tracker.remove(gone);
  tracker.drop_duplicates();
  if (with_motion) add_moving_surfaces(scene, timestamp);
  const auto& objects = tracker.objects();
  std::vector<std::size_t> order(objects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Far ones first, so that the near ones lie on top.
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return objects[a].mask.mean_depth > objects[b].mask.mean_depth;
  });
  constexpr std::size_t most = 255;  // labels are bytes
  for (const std::size_t i : order) {
    if (objects[i].mask.empty() || i >= most) continue;
    paint_object(objects[i].mask, static_cast<std::uint8_t>(i + 1), labels);
  }
  return labels;
}

/// What `classify` needs to know of each feature beside its region; `mask` is empty or all objects.
std::vector<FeatureEvidence> DynamicsModule::State::collect_evidence(
    const std::vector<cv::Point2f>& points, const std::vector<ObjectRegions>& regions,
    const cv::Mat& labels, const cv::Mat& mask, const std::vector<float>& long_residual) const {
  std::vector<FeatureEvidence> evidence(points.size());
  cv::Mat outline;
  const int side = 2 * options.removal.mask_margin + 1;
  if (!mask.empty()) {
    cv::dilate(mask, outline, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto label = value_at<std::uint8_t>(labels, points[i]);
    for (std::size_t o = 0; o < regions.size(); ++o) {
      const bool belongs = label > 0 ? label == o + 1 : regions[o].box.contains(points[i]);
      if (belongs) {
        evidence[i].object_weight = std::max(evidence[i].object_weight, regions[o].weight);
      }
    }
    evidence[i].at_outline = !outline.empty() && value_at<std::uint8_t>(outline, points[i]) != 0;
    evidence[i].long_residual = long_residual[i];
  }
  return evidence;
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
  FeatureMotion found = s.motion.track(grey, frame.depth, points, frame.timestamp);
  s.tracker.update(frame.timestamp, size, detections, s.object_flow(points, found.tracks));
  const DepthView view = make_depth_view(frame.depth, s.rays);
  if (s.options.mode == DynamicsMode::dkp_plus) {
    std::vector<std::uint8_t> low = s.outside_boxes(points), doubtful(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) doubtful[i] = low[i] == 0 ? 1 : 0;
    const Se3 expected = s.motion.current_from_previous();
    s.room.move(expected);
    s.add_room_points(view, points, low);
    s.motion.compensate(frame.depth, points, low, s.frame_seed, found);
    s.room.move(s.motion.current_from_previous() * expected.inverse());
    if (found.camera_motion && found.from_low_points) {
      result.current_from_previous = found.camera_motion->previous_from_current.inverse();
    }
    s.motion.look_back(frame.depth, points, doubtful, found);
  }
  result.removal_ms += watch.lap_ms();

  std::optional<Scene> scene = s.build_scene(frame, view, found);
  const cv::Mat labels = scene ? s.cut_masks(*scene, frame.timestamp, points, found)
                               : cv::Mat(cv::Mat::zeros(size, CV_8UC1));
  s.previous_labels = labels;
  std::vector<ObjectRegions> regions;
  for (const auto& t : s.tracker.objects()) {
    result.objects.push_back(t.object);
    regions.push_back({t.object.box, t.object.weight});
  }
  if (!result.objects.empty()) result.mask = labels > 0;
  result.clustering_ms = watch.lap_ms();

  assign_regions(points, regions, labels, result.features);
  const std::vector<FeatureEvidence> evidence =
      s.collect_evidence(points, regions, labels, result.mask, found.long_residual);
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.features[i].tracked = found.tracks.tracked[i] != 0;
    result.features[i].motion_residual = found.residual[i];
  }
  if (s.options.mode == DynamicsMode::dkp) {
    assign_weights(points, regions, labels, s.options.regions, result.features);
    s.measure_epipolar(found, result.features);
  }
  classify(s.options.mode, s.options.removal, evidence, result.features);
  result.removal_ms += watch.lap_ms();
  return result;
}

}  // namespace dkp_slam
