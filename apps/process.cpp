#include "apps/process.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include <execinfo.h>
#include <fcntl.h>
#include <glog/logging.h>
#include <malloc.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>

namespace dkp_slam::apps {
namespace {

std::atomic<bool> memory_ran_out = false;

bool is_lack_of_memory(const std::exception& error) {
  const auto* const opencv = dynamic_cast<const cv::Exception*>(&error);
  return dynamic_cast<const std::bad_alloc*>(&error) ||
         (opencv && opencv->code == cv::Error::StsNoMem);
}

[[noreturn]] void end_for_lack_of_memory() {
  constexpr std::string_view line =
      "dkp-slam: out of memory where a library cannot go on; end other programs or raise the limit "
      "(ulimit -v)\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());
  _exit(EXIT_FAILURE);
}

/// Where memory runs out some libraries throw out of destructors (OpenCV's BufferArea, Ceres'
/// timers), which no caller can catch. It is told like any other lack of memory, and files are as
/// after a kill; everything else is a bug, and aborts.
[[noreturn]] void on_terminate() {
  thread_local bool entered = false;  // telling may itself fail for lack of memory
  if (memory_ran_out || std::exchange(entered, true)) end_for_lack_of_memory();
  if (std::current_exception()) {
    try {
      throw;
    } catch (const std::exception& error) {
      if (is_lack_of_memory(error)) end_for_lack_of_memory();
      std::fprintf(stderr, "dkp-slam: bug: %s\n", error.what());
    } catch (...) {
      std::fputs("dkp-slam: bug: an exception of no kind\n", stderr);
    }
  }
  std::abort();
}

/// Notes that memory ran out, for `on_terminate`: what is in flight by then tells little.
void watch_memory() {
  std::set_new_handler([] {
    memory_ran_out = true;
    throw std::bad_alloc();
  });
  cv::redirectError([](int code, const char*, const char*, const char*, int, void*) {
    if (code == cv::Error::StsNoMem) memory_ran_out = true;
    return 0;
  });
  std::set_terminate(on_terminate);
}

/// One line of stderr for each message.
class StderrSink : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string text = one_line(std::string(message.payload.data(), message.payload.size()));
    spdlog::details::log_msg shown = message;
    shown.payload = text;
    spdlog::memory_buf_t line;
    formatter_->format(shown, line);
    std::fwrite(line.data(), 1, line.size(), stderr);
  }
  void flush_() override { std::fflush(stderr); }
};

/// Shows as '?' what a terminal takes for a command: control characters, and those of 8 bits as
/// UTF-8 writes them (C2 80 to C2 9F).
void hide_controls(std::string& text, bool line_breaks) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte < ' ' && (line_breaks || byte != '\n')) || byte == 0x7F) text[i] = '?';
    if (byte != 0xC2 || i + 1 == text.size()) continue;
    const auto next = static_cast<unsigned char>(text[i + 1]);
    if (next >= 0x80 && next <= 0x9F) text.replace(i, 2, "?");
  }
}

}  // namespace

void prepare_process() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    const bool closed = fcntl(descriptor, F_GETFD) == -1 && errno == EBADF;
    // open takes the lowest free number, which is this one: those below are open by now.
    if (closed && open("/dev/null", O_RDWR) != descriptor) return;
  }
  // What Ceres' and OpenCV's numerics say of a problem that cannot be solved or an image that is
  // damaged tells a user nothing: what follows from it is said by us.
  FLAGS_minloglevel = google::GLOG_FATAL;
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  // glibc opens what unwinds the stack when an exception or a thread's end first needs it, and
  // aborts where there is no memory left for that; a first look at the stack makes it do so now.
  void* frame = nullptr;
  backtrace(&frame, 1);
  watch_memory();
#ifdef M_ARENA_MAX
  mallopt(M_ARENA_MAX, 2);
#endif
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

std::string message_of(const std::exception& error) {
  if (is_lack_of_memory(error)) {
    return "out of memory; end other programs or raise the limit (ulimit -v)";
  }
  if (const auto* const files = dynamic_cast<const std::filesystem::filesystem_error*>(&error)) {
    return files->path1().string() + ": " + files->code().message() + "; check the path";
  }
  const auto* const system = dynamic_cast<const std::system_error*>(&error);
  if (system && system->code() == std::errc::resource_unavailable_try_again) {
    return "no thread could be started; end other programs or raise the limits (ulimit -u, -v)";
  }
  const auto* const opencv = dynamic_cast<const cv::Exception*>(&error);
  return opencv ? opencv->err : error.what();
}

std::string printable(std::string text) {
  hide_controls(text, false);
  return text;
}

std::string one_line(std::string text) {
  hide_controls(text, true);
  return text;
}

void log_to_stderr() {
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("dkp-slam", std::make_shared<StderrSink>()));
  // On a terminal a message takes the place of the progress bar, which is drawn anew below it. No
  // colours: those are written in pieces, and the bar could get between them.
  spdlog::set_pattern(isatty(STDERR_FILENO) ? "\r\033[Kdkp-slam: %l: %v" : "dkp-slam: %l: %v");
}

}  // namespace dkp_slam::apps
