#include "apps/preloaded_source.h"

#include <utility>

#include "apps/process.h"
#include "apps/progress.h"

namespace dkp_slam::apps {

PreloadedSource::PreloadedSource(std::unique_ptr<RgbdSource> source) : source_(std::move(source)) {
  Progress progress("read", source_->size());
  while (!interrupted()) {
    std::optional<RgbdFrame> frame = source_->read();
    if (!frame) break;
    frames_.push_back(std::move(*frame));
    progress.update(frames_.size(), "frames");
  }
}

std::optional<RgbdFrame> PreloadedSource::read() {
  if (frames_.empty()) return std::nullopt;
  std::optional<RgbdFrame> frame = std::move(frames_.front());
  frames_.pop_front();
  return frame;
}

}  // namespace dkp_slam::apps
