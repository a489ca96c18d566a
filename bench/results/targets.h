#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/results/figures.h"

namespace dkp_slam::bench {

enum class Verdict { pass, fail, not_measured };

/// A limit that a figure has to keep, itself allowed.
struct Bound {
  enum class Side { at_most, at_least };
  double limit = 0.0;
  Side side = Side::at_most;
};

/// One line of the project's table of goals.
struct Target {
  std::string what;
  std::string sequence;  ///< empty: every sequence that was measured, the worst one counts
  std::string mode;
  Quantity quantity = Quantity::ate;
  Bound must;
  std::optional<Bound> aim;
  bool all_localised = false;  ///< a frame lost in any run fails the "must"
};

/// How a target stands.
struct Standing {
  std::optional<double> value;  ///< median over the runs
  std::vector<double> runs;     ///< each of them
  std::string sequence;         ///< where it was measured
  std::size_t failed_runs = 0;  ///< runs without figures; any fails both
  std::size_t lost_frames = 0;  ///< the most in one run
  Verdict must = Verdict::not_measured;
  Verdict aim = Verdict::not_measured;
};

/// The goals: accuracy, masks, features, times, memory.
const std::vector<Target>& targets();

Verdict judge(const std::optional<double>& value, const Bound& bound);

Standing stand(const Target& target, const Results& results);

}  // namespace dkp_slam::bench
