#include "dkp_slam/trace.h"

#include <atomic>
#include <cstdio>
#include <mutex>

#include <fmt/format.h>
#include <pthread.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using Clock = std::chrono::steady_clock;

double microseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::micro>(duration).count();
}

/// The file of the recording under way. Spans of threads that outlive it find it closed.
class Sink {
 public:
  static Sink& instance() {
    static Sink sink;
    return sink;
  }

  bool open() const { return open_.load(std::memory_order_relaxed); }

  void start(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    if (file_ != nullptr) throw Error("two traces cannot be recorded at once");
    file_ = std::fopen(path.c_str(), "w");
    if (file_ == nullptr) {
      throw Error(
          fmt::format("cannot write the trace '{}'; choose another --profile", path.string()));
    }
    path_ = path;
    begin_ = Clock::now();
    ++recording_;
    // Readers take the format without its closing bracket, so that a run that is killed leaves a
    // trace, too.
    failed_ = std::fputs("[\n", file_) < 0;
    open_ = true;
  }

  void add(const char* name, const char* thread, int frame, Clock::time_point from) {
    thread_local const int id = ++threads_;
    thread_local int announced = 0;
    const Clock::time_point now = Clock::now();
    const std::lock_guard lock(mutex_);
    if (file_ == nullptr || from < begin_) return;
    if (announced != recording_) {
      announced = recording_;
      print(fmt::format(
          R"({{"name":"thread_name","ph":"M","pid":1,"tid":{},"args":{{"name":"{}"}}}},)", id,
          thread));
    }
    const std::string args = frame < 0 ? "" : fmt::format(R"(,"args":{{"frame":{}}})", frame);
    print(fmt::format(R"({{"name":"{}","ph":"X","pid":1,"tid":{},"ts":{:.1f},"dur":{:.1f}{}}},)",
                      name, id, microseconds(from - begin_), microseconds(now - from), args));
  }

  /// Path of the file when it is not whole, else nothing.
  std::filesystem::path finish() {
    const std::lock_guard lock(mutex_);
    open_ = false;
    if (file_ == nullptr) return {};
    print(R"({"name":"process_name","ph":"M","pid":1,"args":{"name":"dkp-slam"}})");
    print("]");
    failed_ = std::fclose(file_) != 0 || failed_;
    file_ = nullptr;
    return failed_ ? path_ : std::filesystem::path();
  }

 private:
  void print(const std::string& line) {
    failed_ = std::fputs(line.c_str(), file_) < 0 || std::fputc('\n', file_) < 0 || failed_;
  }

  std::atomic<bool> open_{false};
  std::atomic<int> threads_{0};
  std::mutex mutex_;  // guards what follows
  std::FILE* file_ = nullptr;
  std::filesystem::path path_;
  Clock::time_point begin_;
  int recording_ = 0;
  bool failed_ = false;
};

thread_local const char* thread_name = "main";

}  // namespace

void name_thread(const char* name) {
  thread_name = name;
  constexpr std::size_t most = 15;
  pthread_setname_np(pthread_self(), std::string(name).substr(0, most).c_str());
}

TraceRecording::TraceRecording(const std::filesystem::path& file) { Sink::instance().start(file); }

TraceRecording::~TraceRecording() { Sink::instance().finish(); }

void TraceRecording::finish() {
  if (const auto cut = Sink::instance().finish(); !cut.empty()) {
    throw Error(fmt::format("the trace '{}' is not whole; is the disk full?", cut.string()));
  }
}

TraceSpan::TraceSpan(const char* name, int frame)
    : name_(name), frame_(frame), recorded_(Sink::instance().open()) {
  if (recorded_) start_ = Clock::now();
}

TraceSpan::~TraceSpan() {
  if (recorded_) Sink::instance().add(name_, thread_name, frame_, start_);
}

}  // namespace dkp_slam
