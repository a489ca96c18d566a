#include "apps/progress.h"

#include <algorithm>
#include <csignal>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace dkp_slam::apps {
namespace {

constexpr std::size_t bar_width = 30;
constexpr std::size_t lines_in_all = 10;
constexpr std::size_t steps_per_line_without_total = 100;
constexpr auto redraw_interval = std::chrono::milliseconds(100);

// Set in a signal handler, read in all threads.
std::atomic<bool> interrupt_seen = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void note_interrupt(int signal) {
  interrupt_seen = true;
  std::signal(signal, SIG_DFL);
}

}  // namespace

Progress::Progress(std::string label, std::optional<std::size_t> total, std::FILE* stream)
    : label_(std::move(label)),
      total_(total),
      stream_(stream),
      terminal_(isatty(fileno(stream)) != 0),
      start_(Clock::now()),
      last_drawn_(start_ - redraw_interval) {}

Progress::~Progress() {
  if (line_open_) std::fputc('\n', stream_);
}

void Progress::update(std::size_t done, const std::string& note) {
  const bool last = total_ && done >= *total_;
  if (terminal_) {
    const Clock::time_point now = Clock::now();
    if (!last && now - last_drawn_ < redraw_interval) return;
    last_drawn_ = now;
    draw_bar(done, note);
    return;
  }
  if (done < next_line_ || done == 0) return;
  const std::string separator = note.empty() ? "" : ", ";
  if (total_) {
    show(fmt::format("{}: {} of {}{}{}\n", label_, done, *total_, separator, note));
    // The next tenth that lies ahead, however far this step went; none after the last.
    const std::size_t tenth = done * lines_in_all / std::max<std::size_t>(*total_, 1) + 1;
    next_line_ =
        last ? static_cast<std::size_t>(-1) : (tenth * *total_ + lines_in_all - 1) / lines_in_all;
  } else {
    show(fmt::format("{}: {}{}{}\n", label_, done, separator, note));
    next_line_ = done + steps_per_line_without_total;
  }
}

void Progress::show(const std::string& text) const {
  // Whether it could be written matters to nobody: the terminal may have gone away.
  std::fputs(text.c_str(), stream_);
  std::fflush(stream_);
}

void Progress::draw_bar(std::size_t done, const std::string& note) {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  const double rate = seconds > 0.0 ? static_cast<double>(done) / seconds : 0.0;
  std::string bar;
  if (total_) {
    const std::size_t total = std::max<std::size_t>(*total_, 1);
    const std::size_t filled = std::min(done * bar_width / total, bar_width);
    bar = fmt::format(" [{}{}] {}/{}", std::string(filled, '='),
                      std::string(bar_width - filled, ' '), done, *total_);
  } else {
    bar = fmt::format(" {}", done);
  }
  // Carriage return and "erase to the end of the line": the bar stays on one line.
  show(fmt::format("\r\033[K{}{} {:.1f}/s{}{}", label_, bar, rate, note.empty() ? "" : "  ", note));
  line_open_ = true;
}

void catch_interrupts() {
  std::signal(SIGINT, note_interrupt);
  std::signal(SIGTERM, note_interrupt);
  // Under nohup it is ignored, and stays so.
  if (std::signal(SIGHUP, note_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

bool interrupted() { return interrupt_seen; }

const std::atomic<bool>& interrupt_flag() { return interrupt_seen; }

}  // namespace dkp_slam::apps
