#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/synth/true_detections.h"
#include "dkp_slam/system/engine.h"
#include "tests/support/recording.h"

namespace dkp_slam::testing {

/// A detector with a delay, the same in every run: to each frame it gives the newest of its answers
/// whose image is at least so old. Before the first it has none.
class DelayedDetections {
 public:
  static constexpr double silent = std::numeric_limits<double>::infinity();

  /// `delay` in seconds, or `silent`. `answers` by time.
  DelayedDetections(std::vector<DetectionResult> answers, double delay)
      : answers_(std::move(answers)), delay_(delay) {}
  DetectionResult at(double timestamp) const {
    DetectionResult newest;
    constexpr double rounding = 1e-6;
    for (const DetectionResult& answer : answers_) {
      if (answer.timestamp <= timestamp - delay_ + rounding) newest = answer;
    }
    return newest;
  }

 private:
  std::vector<DetectionResult> answers_;
  double delay_;
};

/// A generated sequence ready for the tracker: images and features, made once to be played often.
struct PreparedRecording {
  Recording recording;
  std::vector<PreparedFrame> frames;     ///< without detections
  std::vector<DetectionResult> answers;  ///< the exact boxes of every frame

  PreparedRecording(const std::string& scenario, std::size_t length, std::size_t first_frame,
                    int divisor)
      : recording(scenario, length, first_frame, divisor) {
    const OrbExtractor extractor{OrbOptions{}};
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
      PreparedFrame prepared;
      prepared.frame = recording.frames[i];
      cv::cvtColor(prepared.frame.colour, prepared.grey, cv::COLOR_BGR2GRAY);
      prepared.orb = extractor.extract(prepared.grey);
      frames.push_back(std::move(prepared));
      answers.push_back(
          {recording.frames[i].timestamp, true, true_detections(recording.truths[i])});
    }
  }
};

/// What a run came to.
struct LateOutcome {
  double dynamic_removed = 0.0;  ///< share of the features on actors
  double static_kept = 0.0;      ///< share of the features on the room
  double error = 0.0;            ///< ATE, metres
  int lost = 0;                  ///< frames
  std::vector<int> objects;      ///< of each frame
};

inline LateOutcome play_late(const PreparedRecording& world, const SlamConfig& options,
                             const DelayedDetections& detector) {
  SlamConfig config = options;
  config.camera = world.recording.camera;
  Engine engine(config);
  LateOutcome outcome;
  double on_actors = 0.0, removed = 0.0, on_room = 0.0, kept = 0.0;
  for (std::size_t i = 0; i < world.frames.size(); ++i) {
    PreparedFrame prepared = world.frames[i];
    prepared.detections = detector.at(prepared.frame.timestamp);
    const auto snapshot = engine.track(std::move(prepared));
    outcome.lost += !snapshot->result.localised;
    outcome.objects.push_back(static_cast<int>(snapshot->dynamics.objects.size()));
    const cv::Mat& mask = world.recording.truths[i].mask;
    for (std::size_t k = 0; k < snapshot->keypoints.size(); ++k) {
      const cv::Point2f& p = snapshot->keypoints[k].pt;
      const bool is_static = snapshot->dynamics.features[k].is_static;
      if (mask.at<std::uint8_t>(cvRound(p.y), cvRound(p.x)) != 0) {
        on_actors += 1.0;
        removed += !is_static;
      } else {
        on_room += 1.0;
        kept += is_static;
      }
    }
  }
  engine.finish();
  outcome.dynamic_removed = on_actors > 0.0 ? removed / on_actors : 1.0;
  outcome.static_kept = kept / on_room;
  outcome.error = world.recording.error(engine.trajectories().front());
  return outcome;
}

}  // namespace dkp_slam::testing
