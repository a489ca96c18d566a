#include "dkp_slam/dynamics/dynamics_module.h"

#include <algorithm>
#include <optional>
#include <string>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/dynamics/compensation/object_flow.h"
#include "dkp_slam/dynamics/masks/mask_depth_choice.h"
#include "dkp_slam/dynamics/motion/static_support.h"
#include "dkp_slam/dynamics/object_masks.h"
#include "dkp_slam/dynamics/parts.h"
#include "dkp_slam/error.h"
#include "dkp_slam/geometry/planes/depth_view.h"
#include "dkp_slam/stopwatch.h"
#include "dkp_slam/trace.h"

namespace dkp_slam {
namespace {

/// A frame on its way through the parts.
struct Work {
  const RgbdFrame& frame;
  std::vector<cv::Point2f> points;  // features, raw pixels
  std::uint64_t seed = 0;
  DepthView view;
  FeatureMotion motion;
  bool few_outside = false;  // of the boxes are too few features to tell the camera's motion
  cv::Mat labels;            // CV_8UC1, image size: i + 1 in the mask of the i-th object
};

std::vector<ObjectRegions> regions_of(const std::vector<DynamicObject>& objects) {
  std::vector<ObjectRegions> regions;
  for (const DynamicObject& o : objects) regions.push_back({o.box, o.weight, o.moves_by_itself});
  return regions;
}

/// What is known of features before a rule judges them.
void describe(const std::vector<cv::Point2f>& points, const std::vector<ObjectRegions>& regions,
              const cv::Mat& labels, const FeatureMotion& motion,
              std::vector<FeatureDynamics>& features) {
  assign_regions(points, regions, labels, features);
  for (std::size_t i = 0; i < points.size(); ++i) {
    features[i].tracked = motion.tracks.tracked[i] != 0;
    features[i].motion_residual = motion.residual[i];
  }
}

}  // namespace

struct DynamicsModule::State {
  State(const Camera& c, const DynamicsOptions& o, std::uint64_t s)
      : size(c.width, c.height),
        options(o),
        seed(s),
        rays(depth_view_rays(c)),
        parts(make_parts(c, o)),
        history(c, o.history, o.compensation.longest_delay),
        mask_depth(o.mask_depth) {}

  cv::Size size;
  DynamicsOptions options;
  std::uint64_t seed;
  cv::Mat rays;
  DynamicsParts parts;
  MotionHistory history;  // carries answers about earlier images
  MaskDepthChoice mask_depth;
  cv::Mat previous_labels;             // Work::labels of the frame that was processed last
  DepthView view;                      // of the frame that was processed last
  std::optional<CameraMotion> motion;  // into it, where what lies outside the boxes tells

  std::vector<std::uint8_t> features_to_follow(const Work& work,
                                               const std::vector<cv::Rect2f>& hidden) const;
  void track(const cv::Mat& grey, const DetectionResult& answer, Work& work);
  void listen_to_planes(const std::vector<std::uint8_t>& support, Work& work);
  void listen_to_unmasked(const std::vector<std::uint8_t>& support, Work& work);
  std::optional<Se3> measure_ego_motion(Work& work);
  void cut_masks(const cv::Mat& grey, Work& work);
  Scene scene_of(const DepthView& view, const Work& work) const;
  void compare_depth(const cv::Mat& grey, const Work& work, const Scene& chosen,
                     const DepthView& stamped);
  void learn_background(const cv::Mat& grey, const Work& work);
  void classify(Work& work, FrameDynamics& result);
  void measure_ego_motion_again(Work& work, FrameDynamics& result);
  void follow_given_masks(const cv::Mat& grey, Work& work, FrameDynamics& result);
};

/// Flags of the features whose motion is asked for; empty for all. Where nothing is known to move
/// some tell the camera's motion, and whether anything does.
std::vector<std::uint8_t> DynamicsModule::State::features_to_follow(
    const Work& work, const std::vector<cv::Rect2f>& hidden) const {
  const int most = options.motion.followed_outside;
  if (!parts.follow_some || most == 0) return {};
  constexpr float margin = 24.0F;  // pixels that a box or its owner may have moved
  return thinned_outside(work.points, hidden, margin, work.frame.depth, most);
}

/// Flow of the features, and the objects carried along with it into this frame.
void DynamicsModule::State::track(const cv::Mat& grey, const DetectionResult& answer, Work& work) {
  const TraceSpan span("flow");
  const double time = work.frame.timestamp;
  std::vector<cv::Rect2f> hidden = parts.objects->self_moving_boxes();  // of the frame before
  for (const Detection& d : answer.detections) {
    if (d.weight >= options.compensation.self_moving_weight) hidden.push_back(d.box);
  }
  work.motion = parts.motion->track(grey, work.frame.depth, work.points, hidden,
                                    features_to_follow(work, hidden), time);
  work.view = make_depth_view(work.frame.depth, rays);
  history.add(time, work.view, work.points, work.motion.tracks);
  parts.objects->update(time, size, answer,
                        object_flow(work.points, work.motion.tracks, previous_labels,
                                    parts.objects->objects().size()),
                        &history);
  if (answer.answered) history.forget_before(answer.timestamp);
}

/// Where somebody whom no box holds bears most of the features the motion may be his: large planes
/// are nobody's.
void DynamicsModule::State::listen_to_planes(const std::vector<std::uint8_t>& support, Work& work) {
  const std::vector<std::uint8_t> on_planes =
      planes_left_behind(work.view, work.points, support, work.motion,
                         static_cast<float>(options.motion.motion.inlier_distance),
                         parts.planes->plane_options(), work.seed);
  if (on_planes.empty()) return;
  parts.motion->measure_ego_motion_anew(work.frame.depth, work.points, on_planes, work.seed,
                                        work.motion);
}

/// In the boxes, too, most of what no mask holds is of the room.
void DynamicsModule::State::listen_to_unmasked(const std::vector<std::uint8_t>& support,
                                               Work& work) {
  if (!work.motion.camera_motion || !work.motion.from_low_points) return;
  const std::vector<std::uint8_t> more =
      unmasked(work.motion, work.points, parts.objects->objects(), previous_labels,
               options.motion.unmasked_distance);
  if (std::count(more.begin(), more.end(), 1) == 0) return;
  parts.motion->refine_ego_motion(work.frame.depth, work.points, support, more, work.motion);
}

/// The camera at this frame from the one before, when what lies outside the objects can tell.
std::optional<Se3> DynamicsModule::State::measure_ego_motion(Work& work) {
  const TraceSpan span("ego-motion");
  std::vector<std::uint8_t> support =
      outside_boxes(work.points, parts.objects->self_moving_boxes());
  std::vector<std::uint8_t> doubtful(support.size());
  for (std::size_t i = 0; i < support.size(); ++i) doubtful[i] = support[i] == 0 ? 1 : 0;
  const Se3 expected = parts.motion->current_from_previous();
  parts.planes->move(expected);
  work.few_outside = std::count(support.begin(), support.end(), 1) < options.motion.enough_outside;
  if (work.few_outside) {
    add_points_on_planes(work.view, work.points, parts.planes->planes(),
                         parts.planes->plane_options(), support);
  }
  parts.motion->measure_ego_motion(work.frame.depth, work.points, support, work.seed, work.motion);
  listen_to_planes(support, work);
  if (options.motion.unmasked_distance > 0.0) listen_to_unmasked(support, work);
  parts.planes->move(parts.motion->current_from_previous() * expected.inverse());
  if (parts.follow_some) {
    parts.motion->follow_more(
        work.frame.depth, work.points,
        near_moving(work.points, work.motion.residual, options.surfaces.moving_short, size),
        work.motion);
  }
  if (parts.long_baseline) {
    parts.motion->look_back(work.frame.depth, work.points, doubtful, work.motion);
  }
  if (work.motion.camera_motion) history.set_ego_motion(parts.motion->current_from_previous());
  if (parts.background) {
    // Where people fill the view the motion may be theirs in part, and what is hidden would drift.
    if (work.motion.camera_motion && !work.few_outside) {
      parts.background->move(parts.motion->current_from_previous());
    } else {
      parts.background->forget();
    }
  }
  if (!work.motion.camera_motion || !work.motion.from_low_points) return std::nullopt;
  return work.motion.camera_motion->previous_from_current.inverse();
}

Scene DynamicsModule::State::scene_of(const DepthView& view, const Work& work) const {
  return parts.masks->scene(view, parts.planes ? parts.planes->planes() : std::vector<Plane>(),
                            work.seed);
}

/// Masks from both depth images, of which `chosen` is the scene of one: which fits better?
void DynamicsModule::State::compare_depth(const cv::Mat& grey, const Work& work,
                                          const Scene& chosen, const DepthView& stamped) {
  if (!any_to_cut(*parts.objects)) return;
  const bool is_stamped = mask_depth.stamped();
  const Scene other = scene_of(is_stamped ? work.view : stamped, work);
  const auto cut = [&](const Scene& scene) {
    return cut_from(*parts.masks, scene, parts.background.get(), grey, work.seed, *parts.objects);
  };
  const cv::Mat first = cut(chosen), second = cut(other);
  mask_depth.compare(grey, is_stamped ? second : first, is_stamped ? first : second);
}

/// Cuts the objects out, where there is anything to cut out.
void DynamicsModule::State::cut_masks(const cv::Mat& grey, Work& work) {
  const TraceSpan span("masks");
  const ObjectTracker::Cover cover = parts.objects->cover(rays.size());
  const bool worth_a_look = parts.surfaces && parts.surfaces->worth_a_look(work.motion);
  if (cover.hidden.empty() && !worth_a_look) {
    work.labels = cv::Mat::zeros(size, CV_8UC1);
    return;
  }
  const bool choice = !work.frame.stamped_depth.empty();
  const DepthView stamped = choice ? make_depth_view(work.frame.stamped_depth, rays) : work.view;
  const DepthView& view = mask_depth.stamped() ? stamped : work.view;
  if (parts.planes) {
    parts.planes->look(view, cover.hidden, cover.people, work.frame.timestamp, work.seed);
  }
  Scene scene = scene_of(view, work);
  if (choice && mask_depth.wants_comparison()) compare_depth(grey, work, scene, stamped);
  if (parts.surfaces) {
    parts.motion->fill_prediction_sigma(work.frame.depth, work.points, work.motion);
    parts.surfaces->judge(work.points, work.motion, scene.surfaces);
  }
  cut_objects(*parts.masks, scene, parts.background.get(), grey, work.seed, *parts.objects);
  if (parts.surfaces) {
    std::vector<ObjectMask> held;
    for (const auto& t : parts.objects->objects()) held.push_back(t.mask);
    for (const ObjectMask& mask :
         parts.surfaces->find(scene.surfaces, held, work.frame.timestamp)) {
      parts.objects->add_moving(mask);
    }
  }
  work.labels = paint_labels(*parts.objects, size);
}

void DynamicsModule::State::learn_background(const cv::Mat& grey, const Work& work) {
  if (!parts.background) return;
  const TraceSpan span("background");
  parts.background->learn(work.view, grey, parts.objects->self_moving_boxes(),
                          work.frame.timestamp);
}

/// Tells static features from dynamic ones.
void DynamicsModule::State::classify(Work& work, FrameDynamics& result) {
  const TraceSpan span("removal");
  const std::vector<ObjectRegions> regions = regions_of(result.objects);
  describe(work.points, regions, work.labels, work.motion, result.features);
  const RemovalInput input{work.points, regions, work.labels, work.frame.depth, work.motion};
  parts.classifier->classify(input, result.features);
  result.doubtful = parts.classifier->doubtful(input);
  if (!parts.flow_compensation) return;
  if (parts.objects->dropped_by_a_miss() > 0) {
    const FlowCompensation::Result found = parts.flow_compensation->compensate(
        work.frame.depth, work.points, work.seed, *parts.motion, work.motion);
    result.current_from_previous = found.current_from_previous;
    for (std::size_t i = 0; i < work.points.size(); ++i) {
      result.features[i].is_static = result.features[i].is_static && found.is_static[i] != 0;
    }
  }
  std::vector<std::uint8_t> is_static;
  for (const FeatureDynamics& f : result.features) is_static.push_back(f.is_static ? 1 : 0);
  parts.flow_compensation->remember(std::move(work.points), std::move(is_static));
}

/// What was found static in the boxes, outside the masks, tells where too little lies outside them.
void DynamicsModule::State::measure_ego_motion_again(Work& work, FrameDynamics& result) {
  std::vector<std::uint8_t> support;
  for (const FeatureDynamics& f : result.features) support.push_back(f.is_static ? 1 : 0);
  parts.motion->measure_ego_motion(work.frame.depth, work.points, support, work.seed, work.motion);
  if (!work.motion.camera_motion || !work.motion.from_low_points) return;
  result.current_from_previous = work.motion.camera_motion->previous_from_current.inverse();
}

/// Mode masks: the masks say what moves, and what lies outside them how the camera moved.
void DynamicsModule::State::follow_given_masks(const cv::Mat& grey, Work& work,
                                               FrameDynamics& result) {
  const RgbdFrame& frame = work.frame;
  work.motion = parts.motion->track(grey, frame.depth, work.points, {}, {}, frame.timestamp);
  work.labels = parts.given_masks->labels(frame, work.points, work.motion.tracks);
  result.mask = work.labels > 0;
  classify(work, result);
  std::vector<std::uint8_t> support;
  for (const FeatureDynamics& f : result.features) support.push_back(f.is_static ? 1 : 0);
  parts.motion->measure_ego_motion(frame.depth, work.points, support, work.seed, work.motion);
  for (std::size_t i = 0; i < support.size(); ++i) {
    result.features[i].motion_residual = work.motion.residual[i];
  }
  if (!work.motion.camera_motion || !work.motion.from_low_points) return;
  result.current_from_previous = work.motion.camera_motion->previous_from_current.inverse();
}

DynamicsModule::DynamicsModule(const Camera& camera, const DynamicsOptions& options,
                               std::uint64_t seed) {
  if (const auto wrong = camera.check()) {
    throw Error("dynamics: camera '" + camera.name + "': " + *wrong);
  }
  state_ = std::make_unique<State>(camera, options, seed);
}
DynamicsModule::~DynamicsModule() = default;
DynamicsModule::DynamicsModule(DynamicsModule&&) noexcept = default;
DynamicsModule& DynamicsModule::operator=(DynamicsModule&&) noexcept = default;

FrameDynamics DynamicsModule::process(const RgbdFrame& frame, const cv::Mat& grey,
                                      const std::vector<cv::KeyPoint>& keypoints,
                                      const DetectionResult& answer) {
  State& s = *state_;
  if (grey.size() != s.size || grey.type() != CV_8UC1 || frame.depth.size() != s.size ||
      frame.depth.type() != CV_32FC1) {
    throw Error("dynamics: frame " + std::to_string(frame.index) +
                " needs grey (8 bit) and depth (float) images of the camera's " +
                std::to_string(s.size.width) + " x " + std::to_string(s.size.height) + " pixels");
  }
  FrameDynamics result;
  result.features.resize(keypoints.size());
  if (!s.parts.classifier) return result;

  Stopwatch watch;
  Work work{frame, {}, 0, {}, {}, false, {}};
  cv::KeyPoint::convert(keypoints, work.points);
  work.seed = s.seed + static_cast<std::uint64_t>(frame.index) * 0x9E3779B97F4A7C15ULL;
  if (s.parts.given_masks) {
    s.follow_given_masks(grey, work, result);
    result.removal_ms = watch.ms();
    return result;
  }
  s.track(grey, answer, work);
  if (s.parts.ego_motion) result.current_from_previous = s.measure_ego_motion(work);
  result.removal_ms += watch.lap_ms();

  s.cut_masks(grey, work);
  s.learn_background(grey, work);
  s.previous_labels = work.labels;
  for (const auto& t : s.parts.objects->objects()) result.objects.push_back(t.object);
  if (!result.objects.empty()) result.mask = work.labels > 0;
  result.clustering_ms = watch.lap_ms();

  s.classify(work, result);
  if (s.parts.ego_motion && work.few_outside) s.measure_ego_motion_again(work, result);
  s.view = std::move(work.view);
  s.motion = work.motion.from_low_points ? work.motion.camera_motion : std::nullopt;
  result.removal_ms += watch.lap_ms();
  return result;
}

void DynamicsModule::judge_added(const RgbdFrame& frame, const std::vector<cv::KeyPoint>& keypoints,
                                 std::size_t first, FrameDynamics& dynamics) const {
  const State& s = *state_;
  if (!s.parts.classifier || !s.parts.classifier->judges_one_by_one() || !s.motion) return;
  const TraceSpan span("removal");
  std::vector<cv::Point2f> all, points;
  cv::KeyPoint::convert(keypoints, all);
  const std::vector<std::uint8_t> outside =
      outside_boxes(all, s.parts.objects->self_moving_boxes());
  std::vector<std::size_t> index;  // of the points in the keypoints
  for (std::size_t i = first; i < all.size(); ++i) {
    if (outside[i] != 0) continue;
    points.push_back(all[i]);
    index.push_back(i);
  }
  if (points.empty()) return;
  const std::vector<ObjectRegions> regions = regions_of(dynamics.objects);
  const FeatureMotion motion = s.parts.motion->measure(frame.depth, points, s.motion);
  std::vector<FeatureDynamics> verdicts(points.size());
  describe(points, regions, s.previous_labels, motion, verdicts);
  constexpr bool bring_back = false;  // a pose that lacks features needs none that move
  const RemovalInput input{points, regions, s.previous_labels, frame.depth, motion, bring_back};
  s.parts.classifier->classify(input, verdicts);
  for (std::size_t k = 0; k < index.size(); ++k) dynamics.features[index[k]] = verdicts[k];
}

cv::Mat DynamicsModule::known_static(const cv::Mat& grey) const {
  const State& s = *state_;
  if (!s.parts.background || s.view.depth.empty()) return {};
  const TraceSpan span("known static");
  cv::Mat known;
  cv::resize(s.parts.background->known(s.view, grey), known, s.size, 0, 0, cv::INTER_NEAREST);
  return known;
}

}  // namespace dkp_slam
