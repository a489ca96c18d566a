#include "dkp_slam/system/front_end.h"

#include <opencv2/imgproc.hpp>
#include <spdlog/spdlog.h>

#include "dkp_slam/system/stopwatch.h"

namespace dkp_slam {
namespace {

constexpr std::size_t line_capacity = 2;  // frames between two stages: evens out, keeps memory low

}  // namespace

FrontEnd::FrontEnd(std::unique_ptr<RgbdSource> source, std::unique_ptr<Detector> detector,
                   const FrontEndOptions& options)
    : options_(options),
      source_(std::move(source)),
      detector_(std::move(detector)),
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
  read_.close();
  extracted_.close();
  detected_.close();
  newest_frame_.close();
  for (std::thread& t : threads_) t.join();
}

std::optional<PreparedFrame> FrontEnd::next() {
  std::optional<PreparedFrame> frame = options_.realtime ? extracted_.pop() : detected_.pop();
  if (!frame) {
    if (error_) std::rethrow_exception(error_);
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
      const Stopwatch watch;
      std::optional<RgbdFrame> frame = source_->read();
      if (!frame) break;
      PreparedFrame prepared;
      prepared.frame = std::move(*frame);
      prepared.decode_ms = watch.ms();
      if (options_.realtime) {
        wait_until_due(prepared.frame.timestamp);
        dropped_frames_ += read_.push_newest(std::move(prepared));
      } else if (!read_.push(std::move(prepared))) {
        return;
      }
    }
  } catch (...) {
    error_ = std::current_exception();
  }
  read_.close();
}

void FrontEnd::wait_until_due(double timestamp) {
  const auto now = [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  };
  if (first_wall_time_ < 0.0) {
    first_wall_time_ = now();
    first_timestamp_ = timestamp;
  }
  const double wait = (timestamp - first_timestamp_) - (now() - first_wall_time_);
  if (wait > 0.0) std::this_thread::sleep_for(std::chrono::duration<double>(wait));
}

void FrontEnd::extract() {
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
    ++detector_failures_;
    spdlog::error("frame {}: the detector {} failed ({}); going on without it", frame.index,
                  detector_->name(), error.what());
    detector_.reset();
    return {};
  }
}

}  // namespace dkp_slam
