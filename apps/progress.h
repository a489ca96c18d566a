#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>

namespace dkp_slam::apps {

/// Progress of a long command on stderr: a bar on a terminal, else a plain line at every tenth of
/// the way (or every 100 steps where the total is not known).
class Progress {
 public:
  explicit Progress(std::string label, std::optional<std::size_t> total,
                    std::FILE* stream = stderr);
  /// Ends the line, also when an exception ends the command.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` steps are finished; `note` is shown behind the bar ("312 points").
  void update(std::size_t done, const std::string& note = "");

 private:
  using Clock = std::chrono::steady_clock;

  void draw_bar(std::size_t done, const std::string& note);
  void show(const std::string& text) const;

  const std::string label_;
  const std::optional<std::size_t> total_;
  std::FILE* const stream_;
  const bool terminal_;
  const Clock::time_point start_;
  Clock::time_point last_drawn_;
  std::size_t next_line_ = 0;  ///< steps at which the next plain line is due
  bool line_open_ = false;
};

/// From here on Ctrl-C makes `interrupted` true, as do SIGTERM and a terminal that goes away
/// (SIGHUP); a second one ends the program at once.
void catch_interrupts();
bool interrupted();
/// What `interrupted` reads, for work that is to be stopped by it.
const std::atomic<bool>& interrupt_flag();

}  // namespace dkp_slam::apps
