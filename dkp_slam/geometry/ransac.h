#pragma once

#include <optional>
#include <utility>

namespace dkp_slam {

/// What `ransac` found and how hard it looked.
template <class Model, class Score>
struct RansacReport {
  std::optional<Model> model;  ///< the best; as `start` where none was better
  Score score{};               ///< of `model`, refined; as `to_beat` where none was better
  int samples = 0;             ///< drawn
  int degenerate = 0;          ///< of them: had no model
};

/// Random sample consensus (Fischler and Bolles 1981), with each better model refined as soon as it
/// is found (Chum, Matas and Kittler 2003). `problem` says what is looked for:
///
///     std::optional<Model> sample();            a model of a random minimal sample; none where the
///                                               sample is degenerate
///     Score score(const Model&, Score best);    more is better; may stop as soon as it is at or
///                                               below `best`
///     void refine(Model&, Score&);              may be left out; never makes the score less
///     double samples_needed(const Model&);      may be left out; so many samples in all are enough
///                                               now that this model is known
///
/// All randomness is the problem's: with the same seed it finds the same. A model must score above
/// `to_beat`, which `start` has, where one is known before.
template <class Model, class Score, class Problem>
RansacReport<Model, Score> ransac(Problem& problem, int most_samples, Score to_beat,
                                  std::optional<Model> start = std::nullopt) {
  RansacReport<Model, Score> report{std::move(start), to_beat};
  double needed = most_samples;
  while (report.samples < most_samples && report.samples < needed) {
    ++report.samples;
    std::optional<Model> model = problem.sample();
    if (!model) {
      ++report.degenerate;
      continue;
    }
    Score score = problem.score(*model, report.score);
    if (!(score > report.score)) continue;
    if constexpr (requires { problem.refine(*model, score); }) problem.refine(*model, score);
    if constexpr (requires { problem.samples_needed(*model); }) {
      needed = problem.samples_needed(*model);
    }
    report.model = std::move(model);
    report.score = score;
  }
  return report;
}

}  // namespace dkp_slam
