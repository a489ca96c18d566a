#include "dkp_slam/system/front_end.h"

#include <spdlog/spdlog.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/stopwatch.h"

namespace dkp_slam {
namespace {

constexpr std::size_t line_capacity = 2;  // frames between two stages: evens out, keeps memory low

}  // namespace

FrontEnd::FrontEnd(std::unique_ptr<RgbdSource> source, std::unique_ptr<Detector> detector,
                   const FrontEndOptions& options)
    : options_(options),
      source_(std::move(source)),
      detector_(std::move(detector)),
      asked_for_(1),
      read_(options.realtime ? 1 : line_capacity),
      extracted_(options.realtime ? 1 : line_capacity),
      detected_(line_capacity),
      newest_frame_(1),
      newest_detections_(1) {
  threads_.emplace_back([this] { read(); });
  threads_.emplace_back([this] { extract(); });
  threads_.emplace_back([this] { options_.realtime ? detect_newest() : detect(); });
}

FrontEnd::~FrontEnd() {
  asked_for_.close();
  read_.close();
  extracted_.close();
  detected_.close();
  newest_frame_.close();
  for (std::thread& t : threads_) t.join();
}

std::optional<PreparedFrame> FrontEnd::next() {
  if (options_.one_at_a_time) asked_for_.push_newest(0);
  std::optional<PreparedFrame> frame = options_.realtime ? extracted_.pop() : detected_.pop();
  if (!frame) {
    if (feature_error_) std::rethrow_exception(feature_error_);
    // Not before that: where extraction failed, the source may still be reading.
    if (source_error_) std::rethrow_exception(source_error_);
    return std::nullopt;
  }
  if (options_.realtime) {
    if (auto newest = newest_detections_.try_pop()) {
      std::tie(frame->detections, frame->detection_ms) = std::move(*newest);
    }
  }
  return frame;
}

void FrontEnd::read() {
  try {
    while (true) {
      if (options_.one_at_a_time && !asked_for_.pop()) return;
      const Stopwatch watch;
      std::optional<RgbdFrame> frame = source_->read();
      skipped_frames_ = source_->skipped();
      if (!frame) break;
      PreparedFrame prepared;
      prepared.frame = std::move(*frame);
      prepared.decode_ms = watch.ms();
      if (options_.realtime) {
        if (!wait_until_due(prepared.frame.timestamp)) return;
        dropped_frames_ += read_.push_newest(std::move(prepared));
      } else if (!read_.push(std::move(prepared))) {
        return;
      }
    }
  } catch (...) {
    skipped_frames_ = source_->skipped();
    source_error_ = std::current_exception();
  }
  read_.close();
}

bool FrontEnd::wait_until_due(double timestamp) {
  using Clock = std::chrono::steady_clock;
  if (!first_moment_) {
    first_moment_ = Clock::now();
    first_timestamp_ = timestamp;
  }
  const std::chrono::duration<double> since_first(timestamp - first_timestamp_);
  return read_.wait_open_until(*first_moment_ +
                               std::chrono::duration_cast<Clock::duration>(since_first));
}

void FrontEnd::extract() {
  try {
    OrbExtractor extractor(options_.orb);
    while (std::optional<PreparedFrame> prepared = read_.pop()) {
      if (options_.realtime) newest_frame_.push_newest(prepared->frame);
      const Stopwatch watch;
      cv::cvtColor(prepared->frame.colour, prepared->grey, cv::COLOR_BGR2GRAY);
      prepared->orb = extractor.extract(prepared->grey);
      prepared->feature_ms = watch.ms();
      if (options_.realtime) {
        dropped_frames_ += extracted_.push_newest(std::move(*prepared));
      } else if (!extracted_.push(std::move(*prepared))) {
        return;
      }
    }
  } catch (...) {
    feature_error_ = std::current_exception();
    read_.close();
  }
  extracted_.close();
  newest_frame_.close();
}

void FrontEnd::detect() {
  while (std::optional<PreparedFrame> prepared = extracted_.pop()) {
    const Stopwatch watch;
    prepared->detections = run_detector(prepared->frame);
    prepared->detection_ms = watch.ms();
    if (!detected_.push(std::move(*prepared))) return;
  }
  detected_.close();
}

void FrontEnd::detect_newest() {
  while (std::optional<RgbdFrame> frame = newest_frame_.pop()) {
    const Stopwatch watch;
    std::vector<Detection> detections = run_detector(*frame);
    newest_detections_.push_newest({std::move(detections), watch.ms()});
  }
}

std::vector<Detection> FrontEnd::run_detector(const RgbdFrame& frame) {
  if (!detector_) return {};
  try {
    return detector_->detect(frame);
  } catch (const std::exception& error) {
    give_up_detector(frame.index, error.what());
  } catch (...) {
    give_up_detector(frame.index, "an exception of unknown type");
  }
  return {};
}

void FrontEnd::give_up_detector(int frame_index, const char* reason) {
  ++detector_failures_;
  spdlog::error("frame {}: the detector {} failed ({}); going on without it", frame_index,
                detector_->name(), reason);
  detector_.reset();
}

}  // namespace dkp_slam
