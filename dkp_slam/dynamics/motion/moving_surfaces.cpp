#include "dkp_slam/dynamics/motion/moving_surfaces.h"

#include <algorithm>
#include <cmath>

namespace dkp_slam {

bool MovingSurfaces::worth_a_look(const FeatureMotion& motion) const {
  return std::count_if(motion.residual.begin(), motion.residual.end(), [&](float r) {
           return r > options_.moving_short;
         }) >= options_.least_features;
}

void MovingSurfaces::judge(const std::vector<cv::Point2f>& points, const FeatureMotion& motion,
                           SegmentMap& surfaces) const {
  // A shaking camera makes everything less certain: thresholds follow the static points' own noise.
  const auto noise = static_cast<float>(motion.camera_motion ? motion.camera_motion->noise : 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float short_residual = motion.residual[i], long_residual = motion.long_residual[i];
    const auto beyond = [&](float sigma) {
      const float least = options_.noise_factor * sigma;
      return short_residual > std::max(options_.moving_short, least) ||
             long_residual > std::max(options_.moving_long, least);
    };
    const bool moves = beyond(noise);
    const bool rests = !moves && long_residual < options_.still_long;
    if (!moves && !rests) continue;
    const int index = segment_near(surfaces, cvRound(points[i].x) / DepthView::step,
                                   cvRound(points[i].y) / DepthView::step);
    if (index < 0) continue;
    Segment& segment = surfaces.segments[static_cast<std::size_t>(index)];
    ++(moves ? segment.moving : segment.still);
    if (moves && beyond(std::hypot(noise, motion.prediction_sigma[i]))) ++segment.surely_moving;
  }
}

std::vector<ObjectMask> MovingSurfaces::find(const SegmentMap& surfaces,
                                             const std::vector<ObjectMask>& held, double time) {
  std::vector<Suspect> still_suspect;
  std::vector<ObjectMask> found;
  const auto image = static_cast<double>(surfaces.labels.total());
  // When half of what is seen seems to move, it is the ego-motion that is wrong.
  const double least = options_.least_share * image, most = 0.5 * image;
  for (std::size_t i = 0; i < surfaces.segments.size(); ++i) {
    const Segment& s = surfaces.segments[i];
    if (!s.proved_moving() || s.moving < options_.least_features) continue;
    if (s.area < least || s.area > most || s.flat) continue;
    ObjectMask mask;
    mask.area = s.box;
    mask.mask = surfaces.labels(s.box) == static_cast<int>(i) + 1;
    mask.mean_depth = s.mean_depth;
    mask.share = static_cast<float>(s.area) / static_cast<float>(s.box.area());
    int overlap = 0;
    for (const ObjectMask& other : held) overlap = std::max(overlap, mask_overlap(mask, other));
    for (const ObjectMask& other : found) overlap = std::max(overlap, mask_overlap(mask, other));
    if (2 * overlap >= s.area) continue;
    const auto known = std::find_if(suspects_.begin(), suspects_.end(), [&](const Suspect& before) {
      return 2 * mask_overlap(mask, before.mask) > s.area;
    });
    const double since = known == suspects_.end() ? time : known->since;
    if (time - since >= options_.least_seconds) {
      found.push_back(std::move(mask));
    } else {
      still_suspect.push_back({std::move(mask), since});
    }
  }
  suspects_ = std::move(still_suspect);
  return found;
}

}  // namespace dkp_slam
