#include "dkp_slam/evaluation/report/evaluation_page.h"

#include <array>
#include <vector>

#include <fmt/format.h>

#include "dkp_slam/evaluation/axes.h"
#include "dkp_slam/evaluation/report/html.h"
#include "dkp_slam/evaluation/report/page_charts.h"

namespace dkp_slam {
namespace {

constexpr std::array<Colour, 4> step_colours{
    {{31, 110, 190}, {214, 70, 60}, {92, 156, 68}, {136, 86, 190}}};

std::string figures_table(const EvaluationReport& report) {
  HtmlTable table({"", "unit", "pairs", "RMSE", "mean", "median", "S.D.", "min", "max"}, 2);
  for (const ReportRow& row : report_rows(report)) {
    if (!row.problem.empty()) {
      table.add({row.name, row.problem});
      continue;
    }
    const ErrorStatistics& s = row.statistics;
    std::vector<HtmlCell> cells{row.name, row.unit, std::to_string(s.count)};
    for (const double value : {s.rmse, s.mean, s.median, s.deviation, s.min, s.max}) {
      cells.emplace_back(fmt::format("{:.6f}", value));
    }
    table.add(cells);
  }
  return table.text();
}

/// The drift over each step, by the time at which the step begins. All pairs have no such order.
std::vector<ErrorSeries> drifts(const EvaluationReport& report, double start) {
  std::vector<ErrorSeries> series;
  const std::vector<StepResult>& steps = report.steps;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!steps[i].error || steps[i].options.all_pairs) continue;
    series.push_back(
        {fmt::format("over {:g} {}", steps[i].options.delta, short_name(steps[i].options.unit)),
         step_colours[i % step_colours.size()],
         {},
         {}});
    for (const RelativeErrorSample& sample : steps[i].error->samples) {
      series.back().times.push_back(sample.from - start);
      series.back().errors.push_back(sample.translation);
    }
  }
  return series;
}

}  // namespace

std::string evaluation_page(std::span<const StampedPose> truth,
                            std::span<const StampedPose> estimate, const EvaluationReport& report,
                            const std::string& truth_name, const std::string& estimate_name) {
  const std::array<ScoredPath, 1> paths{
      {{"estimate", chart::estimate_colour, {estimate.begin(), estimate.end()}, report.absolute}}};
  std::string body = "<h1>dkp-slam: eval</h1>\n";
  body += fmt::format("<p class=\"lead\">{}: {} poses, of which {} were compared with {}</p>\n",
                      escaped(estimate_name), report.estimate_poses,
                      report.absolute.statistics.count, escaped(truth_name));
  body += figures_table(report);
  std::vector<std::string> charts{path_chart(truth, paths, report.association), error_chart(paths)};
  const std::vector<ErrorSeries> drift = drifts(report, start_of(paths));
  if (!drift.empty()) charts.push_back(error_chart("Drift (RPE)", drift));
  body += html_figure(charts,
                      "Both paths after rigid alignment, their distance (ATE) and the drift over "
                      "each step (RPE) over time. " +
                          chart_help());
  return html_page("dkp-slam: eval", body);
}

}  // namespace dkp_slam
