#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/dynamics/dynamics_module.h"
#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/synth/true_detections.h"
#include "tests/support/recording.h"

namespace dkp_slam::testing {

/// Detections of every frame of a sequence.
using DetectionList = std::vector<std::vector<Detection>>;

/// A synthetic sequence with what the modules of dynamics are given of it, and all that is true.
struct SyntheticWorld {
  Recording recording;
  std::vector<cv::Mat> grey;
  std::vector<std::vector<cv::KeyPoint>> keypoints;
  DetectionList boxes;       ///< the exact boxes, without silhouettes
  std::vector<int> walkers;  ///< actors who walk in these frames; the other people sit

  SyntheticWorld(const std::string& scenario, std::size_t length, std::size_t first_frame,
                 std::vector<int> walking)
      : recording(scenario, length, first_frame), walkers(std::move(walking)) {
    const OrbExtractor orb;
    for (std::size_t i = 0; i < length; ++i) {
      grey.emplace_back();
      cv::cvtColor(recording.frames[i].colour, grey.back(), cv::COLOR_BGR2GRAY);
      keypoints.push_back(orb.extract(grey.back()).keypoints);
      boxes.push_back(true_detections(recording.truths[i]));
    }
  }
  std::size_t size() const { return grey.size(); }

  /// What the whole module makes of these detections, frame by frame.
  std::vector<FrameDynamics> run(DynamicsMode mode, const DetectionList& detections) const {
    DynamicsOptions options;
    options.mode = mode;
    DynamicsModule module(recording.camera, options);
    std::vector<FrameDynamics> results;
    for (std::size_t i = 0; i < size(); ++i) {
      results.push_back(module.process(recording.frames[i], grey[i], keypoints[i],
                                       {recording.frames[i].timestamp, true, detections[i]}));
    }
    return results;
  }

  bool walks(int instance) const {
    return std::find(walkers.begin(), walkers.end(), instance) != walkers.end();
  }

  /// The actor's number at a keypoint's pixel, 0 for the room.
  int instance_at(std::size_t frame, std::size_t keypoint) const {
    const cv::Point2f& p = keypoints[frame][keypoint].pt;
    return recording.truths[frame].instance.at<std::uint8_t>(cvRound(p.y), cvRound(p.x));
  }
};

/// Somebody walks up to the camera, which moves, while somebody else sits. Rendered once a program.
const SyntheticWorld& walking_world();
/// People sit and gesture while the camera stands. Rendered once a program.
const SyntheticWorld& sitting_world();

/// A detector's boxes: every side off by a normal deviate of this share of the box's size.
DetectionList jittered(const DetectionList& exact, double share, const cv::Size& image,
                       std::uint64_t seed);

/// One person in one frame.
struct PersonMask {
  std::size_t frame = 0;
  int instance = 0;
  double iou = 0.0;     ///< intersection over union
  double recall = 0.0;  ///< share of the person in the mask
};

/// Of every person who covers at least `least_share` of the image, in frames where `wanted` holds:
/// intersection over union of the mask with the exact silhouette. The mask counts within the exact
/// box grown by a quarter to each side, apart from what lies on other actors.
std::vector<PersonMask> score_people(
    const SyntheticWorld& world, const std::vector<FrameDynamics>& results, double least_share,
    const std::function<bool(std::size_t frame, int instance)>& wanted);

/// Shares of features by what they lie on in truth, in frames where `wanted` holds.
struct FeatureShares {
  double people_removed = 0.0;   ///< of those on anybody
  double walkers_removed = 0.0;  ///< of those on people who walk
  double static_kept = 0.0;      ///< of those on the room
};
FeatureShares feature_shares(const SyntheticWorld& world, const std::vector<FrameDynamics>& results,
                             const std::function<bool(std::size_t frame)>& wanted = nullptr);

/// The value below which this share of the values lies. At least one value.
double quantile(std::vector<double> values, double share);

}  // namespace dkp_slam::testing
