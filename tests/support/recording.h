#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
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
  std::vector<SyntheticTruth> truths;  ///< of each frame, but for the exact depth
  Trajectory truth;
  Camera camera;

  /// `divisor`: 1 for 640 x 480 pixels, 2 for half the width, which is rendered in a third of the
  /// time. All test programs share what was rendered before by this build, see recording_child.cpp;
  /// a part counted from the same first frame, too. Throws `Error` where nothing can be rendered.
  Recording(const std::string& scenario, std::size_t length, std::size_t first_frame = 0,
            int divisor = 1);
  /// Rendered here, as the camera is nobody else's. Frames are counted at its rate.
  Recording(const std::string& scenario, const Camera& seen_by, std::size_t length,
            std::size_t first_frame);

  std::unique_ptr<RgbdSource> play(std::size_t first = 0) const {
    return std::make_unique<RecordedSource>(frames, first);
  }
  /// Of a path against the true one, RMSE in metres.
  double error(const Trajectory& path) const { return absolute_error(truth, path).statistics.rmse; }

  /// Writes everything but the camera, whole or not at all. Throws `Error`.
  void save(const std::filesystem::path& file) const;
  /// How many frames such a file holds; 0 where there is none.
  static std::size_t length_of(const std::filesystem::path& file);

 private:
  /// The first frames of a file of `save`. Throws `Error` where it holds fewer.
  void load(const std::filesystem::path& file, std::size_t length);
};

}  // namespace dkp_slam::testing
