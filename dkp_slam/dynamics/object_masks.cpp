#include "dkp_slam/dynamics/object_masks.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace dkp_slam {
namespace {

/// It moves by itself, and its detector did not tell its silhouette.
bool needs_cutting(const ObjectTracker::Tracked& t) {
  return t.object.moves_by_itself && t.silhouette.empty();
}

ObjectMask cut_out(const MaskCutter& cutter, const Scene& scene, StaticBackground* background,
                   const cv::Mat& grey, std::uint64_t seed, const ObjectTracker::Tracked& t) {
  ObjectMask mask = cutter.cut(scene, t.object.box, ObjectTracker::prior_of(t), seed);
  if (background) background->correct(scene.view, grey, t.object.box, mask);
  return mask;
}

/// False when an object that the detector missed is not to be found in the depth either.
bool cut_object(const MaskCutter& cutter, const Scene& scene, StaticBackground* background,
                const cv::Mat& grey, std::uint64_t seed, ObjectTracker& objects,
                std::size_t index) {
  const ObjectTracker::Tracked& t = objects.objects()[index];
  if (!t.object.moves_by_itself) return true;
  if (!t.silhouette.empty()) {
    objects.set_mask(index, mask_from_silhouette(scene.view, t.silhouette, t.detected_box), true);
    return true;
  }
  const ObjectMask mask = cut_out(cutter, scene, background, grey, seed, t);
  objects.set_mask(index, mask, mask.moving);
  return !t.object.compensated || !t.missed || !(mask.empty() || mask.still);
}

}  // namespace

void cut_objects(const MaskCutter& cutter, const Scene& scene, StaticBackground* background,
                 const cv::Mat& grey, std::uint64_t seed, ObjectTracker& objects) {
  std::vector<bool> gone(objects.objects().size(), false);
  for (std::size_t o = 0; o < gone.size(); ++o) {
    gone[o] = !cut_object(cutter, scene, background, grey, seed, objects, o);
  }
  objects.remove(gone);
  objects.drop_duplicates();
}

bool any_to_cut(const ObjectTracker& objects) {
  return std::any_of(objects.objects().begin(), objects.objects().end(), needs_cutting);
}

cv::Mat cut_from(const MaskCutter& cutter, const Scene& scene, StaticBackground* background,
                 const cv::Mat& grey, std::uint64_t seed, const ObjectTracker& objects) {
  cv::Mat masks = cv::Mat::zeros(grey.size(), CV_8UC1);
  for (const ObjectTracker::Tracked& t : objects.objects()) {
    if (!needs_cutting(t)) continue;
    const ObjectMask mask = cut_out(cutter, scene, background, grey, seed, t);
    if (!mask.empty()) paint_object(mask, 1, masks);
  }
  return masks;
}

std::vector<std::uint8_t> unmasked(const FeatureMotion& motion,
                                   const std::vector<cv::Point2f>& points,
                                   const std::vector<ObjectTracker::Tracked>& objects,
                                   const cv::Mat& labels_before, double most) {
  const cv::Rect image(cv::Point(), labels_before.size());
  std::vector<std::uint8_t> flags(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(static_cast<double>(motion.residual[i]) <= most)) continue;  // NaN for none
    const cv::Point before(motion.tracks.previous[i]);
    if (!image.contains(before) || labels_before.at<std::uint8_t>(before) != 0) continue;
    bool in_box = false, known = true;
    for (const auto& t : objects) {
      if (!t.object.moves_by_itself || !t.object.box.contains(points[i])) continue;
      in_box = true;
      known = known && t.object.named() && !t.mask.empty();
    }
    flags[i] = in_box && known ? 1 : 0;
  }
  return flags;
}

cv::Mat paint_labels(const ObjectTracker& tracker, const cv::Size& image) {
  cv::Mat labels = cv::Mat::zeros(image, CV_8UC1);
  const auto& objects = tracker.objects();
  std::vector<std::size_t> order(objects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
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

}  // namespace dkp_slam
