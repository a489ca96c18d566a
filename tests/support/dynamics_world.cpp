#include "tests/support/dynamics_world.h"

#include <algorithm>

namespace dkp_slam::testing {
namespace {

bool is_person(const SyntheticObject& object) { return object.class_name == "person"; }

cv::Rect grown(const cv::Rect& box, const cv::Size& image) {
  const cv::Size by(box.width / 4, box.height / 4);
  return (box - cv::Point(by.width, by.height) + by + by) & cv::Rect({0, 0}, image);
}

}  // namespace

const SyntheticWorld& walking_world() {
  static const SyntheticWorld world("walking_xyz", 48, 85, {1});
  return world;
}

const SyntheticWorld& sitting_world() {
  static const SyntheticWorld world("sitting_static", 12, 0, {});
  return world;
}

DetectionList jittered(const DetectionList& exact, double share, const cv::Size& image,
                       std::uint64_t seed) {
  cv::RNG random(seed);
  DetectionList result = exact;
  for (auto& detections : result) {
    for (Detection& d : detections) {
      const float w = d.box.width, h = d.box.height;
      const auto off = [&](float size) {
        return static_cast<float>(random.gaussian(share)) * size;
      };
      cv::Point2f tl = d.box.tl(), br = d.box.br();
      tl += {off(w), off(h)};
      br += {off(w), off(h)};
      d.box = cv::Rect2f(tl, br) & cv::Rect2f(cv::Rect({0, 0}, image));
    }
  }
  return result;
}

std::vector<PersonMask> score_people(
    const SyntheticWorld& world, const std::vector<FrameDynamics>& results, double least_share,
    const std::function<bool(std::size_t frame, int instance)>& wanted) {
  std::vector<PersonMask> people;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const SyntheticTruth& truth = world.recording.truths[i];
    const double image = static_cast<double>(truth.instance.total());
    for (const SyntheticObject& object : truth.objects) {
      if (!is_person(object) || object.pixels < least_share * image) continue;
      if (!wanted(i, object.instance)) continue;
      PersonMask person{i, object.instance};
      if (!results[i].mask.empty()) {
        const cv::Rect around = grown(object.box, truth.instance.size());
        const cv::Mat own = truth.instance(around) == object.instance;
        const cv::Mat others = (truth.instance(around) != 0) & ~own;
        const cv::Mat mask = results[i].mask(around) & ~others;
        const double common = cv::countNonZero(mask & own);
        person.iou = common / cv::countNonZero(mask | own);
        person.recall = common / object.pixels;
      }
      people.push_back(person);
    }
  }
  return people;
}

FeatureShares feature_shares(const SyntheticWorld& world, const std::vector<FrameDynamics>& results,
                             const std::function<bool(std::size_t frame)>& wanted) {
  double on_people = 0.0, people_removed = 0.0, on_walkers = 0.0, walkers_removed = 0.0;
  double on_room = 0.0, room_kept = 0.0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (wanted && !wanted(i)) continue;
    std::vector<bool> person(256, false);
    for (const SyntheticObject& object : world.recording.truths[i].objects) {
      person[static_cast<std::size_t>(object.instance)] = is_person(object);
    }
    for (std::size_t k = 0; k < results[i].features.size(); ++k) {
      const int instance = world.instance_at(i, k);
      const double kept = results[i].features[k].is_static ? 1.0 : 0.0;
      if (instance == 0) {
        on_room += 1.0;
        room_kept += kept;
      } else if (person[static_cast<std::size_t>(instance)]) {
        on_people += 1.0;
        people_removed += 1.0 - kept;
        on_walkers += world.walks(instance) ? 1.0 : 0.0;
        walkers_removed += world.walks(instance) ? 1.0 - kept : 0.0;
      }
    }
  }
  return {people_removed / on_people, walkers_removed / std::max(1.0, on_walkers),
          room_kept / on_room};
}

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace dkp_slam::testing
