#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "dkp_slam/sensor/rgbd_source.h"

namespace dkp_slam::testing {

/// Plays frames as something makes of them what else the camera might have seen. Whoever changes an
/// image gives the frame another one: those of the source may be others' too.
class ChangedSource : public RgbdSource {
 public:
  using Change = std::function<void(RgbdFrame&)>;
  ChangedSource(std::unique_ptr<RgbdSource> source, Change change)
      : source_(std::move(source)), change_(std::move(change)) {}
  std::string description() const override { return "changed"; }
  std::optional<std::size_t> size() const override { return source_->size(); }
  std::size_t skipped() const override { return 0; }
  std::optional<RgbdFrame> read() override {
    auto frame = source_->read();
    if (frame) change_(*frame);
    return frame;
  }

 private:
  const std::unique_ptr<RgbdSource> source_;
  const Change change_;
};

}  // namespace dkp_slam::testing
