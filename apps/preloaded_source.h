#pragma once

#include <deque>
#include <memory>

#include "dkp_slam/sensor/rgbd_source.h"

namespace dkp_slam::apps {

/// All frames of another source, read before the first is given: what comes after takes the time
/// that it takes with a camera, which decodes nothing. Two megabytes a frame of 640 x 480.
class PreloadedSource : public RgbdSource {
 public:
  /// Reads until the source ends, or an interrupt.
  explicit PreloadedSource(std::unique_ptr<RgbdSource> source);

  std::string description() const override { return source_->description(); }
  std::optional<std::size_t> size() const override { return source_->size(); }
  std::optional<RgbdFrame> read() override;
  std::size_t skipped() const override { return source_->skipped(); }
  std::size_t without_mask() const override { return source_->without_mask(); }

 private:
  std::unique_ptr<RgbdSource> source_;
  std::deque<RgbdFrame> frames_;
};

}  // namespace dkp_slam::apps
