#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dkp_slam/evaluation/absolute_error.h"
#include "dkp_slam/geometry/sensor_scale.h"
#include "dkp_slam/synth/source.h"

namespace dkp_slam::testing {

/// Plays frames from memory, from the `first` one on.
class RecordedSource : public RgbdSource {
 public:
  explicit RecordedSource(const std::vector<RgbdFrame>& frames, std::size_t first = 0)
      : frames_(frames), next_(first) {}
  std::string description() const override { return "recorded"; }
  std::optional<std::size_t> size() const override { return frames_.size(); }
  std::size_t skipped() const override { return 0; }
  std::optional<RgbdFrame> read() override {
    if (next_ == frames_.size()) return std::nullopt;
    return frames_[next_++];
  }

 private:
  const std::vector<RgbdFrame>& frames_;
  std::size_t next_;
};

/// The same view with fewer pixels.
inline Camera smaller(const Camera& camera, int divisor) {
  return resized(camera, camera.width / divisor, camera.height / divisor);
}

/// A synthetic scenario with all that is true of it. Rendered once, to be played often.
struct Recording {
  std::vector<RgbdFrame> frames;
  std::vector<SyntheticTruth> truths;  ///< of each frame
  Trajectory truth;
  Camera camera;

  /// `divisor`: 1 for 640 x 480 pixels, 2 for half the width, which is rendered in a third of the
  /// time.
  Recording(const std::string& scenario, std::size_t length, std::size_t first_frame = 0,
            int divisor = 1)
      : Recording(scenario, smaller(SyntheticOptions::default_camera(), divisor), length,
                  first_frame) {}
  /// Frames are counted at that camera's rate.
  Recording(const std::string& scenario, const Camera& seen_by, std::size_t length,
            std::size_t first_frame) {
    SyntheticOptions options = synthetic_scenario(scenario);
    options.frames = length;
    options.first_frame = first_frame;
    camera = options.camera = seen_by;
    SyntheticSource world(options);
    while (auto frame = world.read()) {
      truth.push_back({frame->timestamp, world.truth().world_from_camera});
      truths.push_back(world.truth());
      frames.push_back(std::move(*frame));
    }
  }
  std::unique_ptr<RgbdSource> play(std::size_t first = 0) const {
    return std::make_unique<RecordedSource>(frames, first);
  }
  /// Of a path against the true one, RMSE in metres.
  double error(const Trajectory& path) const { return absolute_error(truth, path).statistics.rmse; }
};

}  // namespace dkp_slam::testing
