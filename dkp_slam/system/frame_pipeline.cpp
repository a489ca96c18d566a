#include "dkp_slam/system/frame_pipeline.h"

#include <spdlog/spdlog.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/stopwatch.h"
#include "dkp_slam/system/usable_detections.h"
#include "dkp_slam/thread_priority.h"
#include "dkp_slam/trace.h"

namespace dkp_slam {
namespace {

/// Live the detector looks at no more images than a 30 Hz camera gives: with a faster one it would
/// take all of a core, and objects are carried from one look to the next all the same.
constexpr std::chrono::milliseconds least_look(30);

/// The same for as long after a frame was dropped as `behind` says: there is too little time for
/// all, and of a look and a frame the frame is worth more.
constexpr std::chrono::milliseconds late_look(66);
constexpr std::chrono::seconds behind(1);

/// Live a frame waits for the tracker no longer than this when the next one is there.
constexpr std::chrono::milliseconds longest_queueing(45);

/// So long after it was fed a startling frame goes on without an answer.
constexpr std::chrono::milliseconds longest_wait(50);

void find_features(const OrbExtractor& extractor, PreparedFrame& prepared) {
  const TraceSpan span("features", prepared.frame.index);
  const Stopwatch watch;
  cv::cvtColor(prepared.frame.colour, prepared.grey, cv::COLOR_BGR2GRAY);
  prepared.orb = extractor.extract(prepared.grey);
  prepared.feature_ms = watch.ms();
}

}  // namespace

FramePipeline::FramePipeline(std::unique_ptr<Detector> detector, const OrbOptions& orb, bool live,
                             double startling)
    : orb_(orb),
      live_(live),
      detector_(std::move(detector)),
      detecting_(detector_ != nullptr),
      startle_(startling),
      incoming_(line_capacity),
      extracted_(live ? live_capacity : line_capacity),
      detected_(line_capacity),
      newest_frame_(1),
      startled_(1),
      newest_detections_(1) {
  try {
    threads_.emplace_back([this] {
      name_thread("features");
      run(&FramePipeline::extract);
      extracted_.close();
      newest_frame_.close();
    });
    threads_.emplace_back([this] {
      name_thread("detector");
      if (live_) lower_priority();  // a frame that waits for its answer leaves it the time
      run(live_ ? &FramePipeline::detect_newest : &FramePipeline::detect);
      if (live_) return;
      extracted_.close();
      detected_.close();
    });
  } catch (...) {  // no thread was to be had
    end();
    throw;
  }
}

FramePipeline::~FramePipeline() { end(); }

void FramePipeline::end() {
  stop();
  for (std::thread& t : threads_) t.join();
}

void FramePipeline::stop() {
  for (BoundedQueue<PreparedFrame>* queue : {&incoming_, &extracted_, &detected_}) {
    queue->clear();
    queue->close();
  }
  newest_frame_.close();
  startled_.close();
  newest_detections_.close();
}

bool FramePipeline::push(RgbdFrame frame) {
  PreparedFrame prepared;
  prepared.frame = std::move(frame);
  prepared.fed = std::chrono::steady_clock::now();
  if (!live_) return incoming_.push(std::move(prepared));
  prepared.startling = startle_.by(prepared.frame.timestamp, prepared.frame.depth);
  newest_frame_.push_newest(prepared.frame);
  if (prepared.startling) startled_.push_newest(0);
  dropped_frames_ += incoming_.push_newest(std::move(prepared));
  return !incoming_.closed();
}

std::optional<PreparedFrame> FramePipeline::next() {
  std::optional<PreparedFrame> frame = live_ ? extracted_.pop() : detected_.pop();
  if (!frame) {
    const std::lock_guard lock(error_mutex_);
    if (error_) std::rethrow_exception(error_);
    return std::nullopt;
  }
  if (live_) take_answer(*frame);
  return frame;
}

/// Each answer goes with one frame; those until the next are without one.
void FramePipeline::take_answer(PreparedFrame& frame) {
  const bool waits = frame.startling && detecting_;
  const auto until = waits ? frame.fed + longest_wait : std::chrono::steady_clock::time_point();
  while (auto newest = newest_detections_.pop_until(until)) {
    std::tie(frame.detections, frame.detection_ms) = std::move(*newest);
    if (!waits || frame.detections.timestamp >= frame.frame.timestamp) return;
  }
}

void FramePipeline::run(void (FramePipeline::*stage)()) {
  try {
    (this->*stage)();
  } catch (...) {
    {
      const std::lock_guard lock(error_mutex_);
      if (!error_) error_ = std::current_exception();
    }
    incoming_.close();
  }
}

void FramePipeline::extract() {
  OrbExtractor extractor(orb_);
  while (std::optional<PreparedFrame> prepared = incoming_.pop()) {
    find_features(extractor, *prepared);
    if (live_) {
      const auto fed = prepared->fed;
      dropped_frames_ += extracted_.push_newest(
          std::move(*prepared),
          [fed](const PreparedFrame& waiting) { return fed - waiting.fed > longest_queueing; });
    } else if (!extracted_.push(std::move(*prepared))) {
      return;
    }
  }
}

void FramePipeline::detect() {
  while (std::optional<PreparedFrame> prepared = extracted_.pop()) {
    const Stopwatch watch;
    prepared->detections = run_detector(prepared->frame);
    if (prepared->detections.answered) prepared->detection_ms = watch.ms();
    if (!detected_.push(std::move(*prepared))) return;
  }
}

void FramePipeline::detect_newest() {
  while (std::optional<RgbdFrame> frame = newest_frame_.pop()) {
    const auto began = std::chrono::steady_clock::now();
    const Stopwatch watch;
    DetectionResult result = run_detector(*frame);
    if (result.answered) newest_detections_.push_newest({std::move(result), watch.ms()});
    rest(began);
  }
}

/// After a look that began then, until the next one is due or somebody may have stepped into the
/// view.
void FramePipeline::rest(std::chrono::steady_clock::time_point began) {
  const auto now = std::chrono::steady_clock::now();
  if (const int dropped = dropped_frames_; dropped > dropped_before_) {
    dropped_before_ = dropped;
    late_until_ = now + behind;
  }
  startled_.pop_until(began + (now < late_until_ ? late_look : least_look));
}

DetectionResult FramePipeline::run_detector(const RgbdFrame& frame) {
  DetectionResult result;
  result.timestamp = frame.timestamp;
  if (!detector_) return result;
  const TraceSpan span("detection", frame.index);
  try {
    if (!detector_->looks_at(frame)) return result;
    result.detections = usable_detections(detector_->detect(frame), frame.colour.size());
    result.answered = true;
  } catch (const std::exception& error) {
    give_up_detector(frame.index, error.what());
  } catch (...) {
    give_up_detector(frame.index, "an exception of unknown type");
  }
  return result;
}

void FramePipeline::give_up_detector(int frame_index, const char* reason) {
  ++detector_failures_;
  detecting_ = false;
  spdlog::error("frame {}: the detector {} failed ({}); going on without it", frame_index,
                detector_->name(), reason);
  detector_.reset();
}

}  // namespace dkp_slam
