#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace dkp_slam {

/// Names the calling thread, for traces, debuggers and `top -H`; at most 15 characters are seen
/// there.
void name_thread(const char* name);

/// While it lives, what all threads do goes into a file in Chrome's trace format
/// (docs.google.com/document/d/1CvAClvFfyA5R-PhYUmn5OOQtYMH4h6I0nSsKchNAySU), which Perfetto
/// (ui.perfetto.dev) and chrome://tracing open, also that of a run that was killed. One at a time.
class TraceRecording {
 public:
  /// Throws `Error` when the file cannot be written.
  explicit TraceRecording(const std::filesystem::path& file);
  ~TraceRecording();
  TraceRecording(const TraceRecording&) = delete;
  TraceRecording& operator=(const TraceRecording&) = delete;

  /// Ends the recording. Throws `Error` when not all of it could be written.
  void finish();
};

/// What the calling thread does as long as the span lives. Costs a microsecond while something is
/// recorded, else next to nothing.
class TraceSpan {
 public:
  /// `name` must outlive the span; `frame`: index of the frame that it is done for, -1 for none.
  explicit TraceSpan(const char* name, int frame = -1);
  ~TraceSpan();
  TraceSpan(const TraceSpan&) = delete;
  TraceSpan& operator=(const TraceSpan&) = delete;

 private:
  const char* name_;
  int frame_;
  bool recorded_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace dkp_slam
