#include "dkp_slam/evaluation/report/bench_report.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/timings.h"
#include "dkp_slam/evaluation/report/bench_tables.h"
#include "dkp_slam/evaluation/report/page_charts.h"
#include "dkp_slam/evaluation/report/record_set.h"
#include "dkp_slam/export/trajectory.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t runs_wanted = 3;

/// The median run of a configuration and what is left of it.
struct DrawnRun {
  BenchConfig config;
  ScoredPath path;
  FrameValues times;
};

std::optional<DrawnRun> load_run(const RecordSet& set, const RunRecord& record,
                                 const Trajectory& truth, const fs::path& runs) {
  const fs::path folder = runs / run_name(record);
  if (!fs::exists(folder / "trajectory.txt") || !fs::exists(folder / "timings.csv")) {
    return std::nullopt;
  }
  try {
    DrawnRun run{config_of(record), {}, {}};
    const std::string label = set.label(run.config);
    run.path.name = run.times.name = label;
    run.path.colour = run.times.colour = set.colour(run.config);
    run.path.estimate = read_trajectory(folder / "trajectory.txt");
    run.path.error = absolute_error(truth, run.path.estimate);
    std::ifstream in(folder / "timings.csv");
    std::ostringstream text;
    text << in.rdbuf();
    const auto columns = read_timings(text.str());
    if (const auto frame = columns.find("frame_ms"); frame != columns.end()) {
      run.times.values = frame->second;
    }
    return run;
  } catch (const Error& error) {
    spdlog::warn("{}: not drawn: {}", run_name(record), error.what());
    return std::nullopt;
  }
}

std::string sequence_figure(const RecordSet& set, const std::string& sequence,
                            const fs::path& runs) {
  const fs::path truth_file = runs / sequence / "groundtruth.txt";
  if (!fs::exists(truth_file)) return "";
  const Trajectory truth = read_trajectory(truth_file);
  const std::vector<BenchConfig> best = set.best_configs();
  std::vector<ScoredPath> all, few;
  std::vector<FrameValues> times;
  for (const BenchConfig& config : set.configs()) {
    const RunRecord* record = median_run(set.runs(sequence, config));
    if (!record) continue;
    const auto run = load_run(set, *record, truth, runs);
    if (!run) continue;
    all.push_back(run->path);
    // More than these would hide each other.
    if (config.mode == "off" || std::find(best.begin(), best.end(), config) != best.end()) {
      few.push_back(run->path);
      if (!run->times.values.empty()) times.push_back(run->times);
    }
  }
  if (all.empty()) return "";
  std::vector<std::string> charts{path_chart(truth, few.empty() ? all : few), error_chart(all)};
  if (!times.empty()) {
    charts.push_back(histogram_chart("Time per frame", times, "time of a frame", "ms"));
  }
  return "<h3>" + escaped(sequence) + "</h3>\n" +
         html_figure(charts,
                     "Paths, distance from the true path over time, and time per frame; of each "
                     "mode the run whose ATE is the median. " +
                         chart_help());
}

std::string figures_section(const RecordSet& set, const fs::path& runs) {
  std::string figures;
  for (const std::string& sequence : set.sequences()) {
    figures += sequence_figure(set, sequence, runs);
  }
  if (figures.empty()) return "";
  return html_heading("Paths, errors and times", "figures") + figures;
}

/// Every different value of a field.
template <class Field>
std::string all_of(const RecordSet& set, Field field) {
  std::set<std::string> values;
  for (const RunRecord& record : set.records()) {
    if (!field(record).empty()) values.insert(field(record));
  }
  return fmt::format("{}", fmt::join(values, "; "));
}

/// Whether a sequence with a mode was run fewer times than a median needs.
bool too_few_runs(const RecordSet& set) {
  for (const std::string& sequence : set.sequences()) {
    for (const BenchConfig& config : set.configs()) {
      const std::size_t count = set.runs(sequence, config).size();
      if (count > 0 && count < runs_wanted) return true;
    }
  }
  return false;
}

std::string warning(const std::string& text) {
  return "<p class=\"warning\">" + escaped(text) + "</p>\n";
}

std::string head(const RecordSet& set, const BenchReportOptions& options) {
  const auto failed = static_cast<std::size_t>(
      std::count_if(set.records().begin(), set.records().end(),
                    [](const RunRecord& r) { return !r.problem.empty(); }));
  std::string text = "<h1>dkp-slam: bench</h1>\n";
  text += fmt::format("<p class=\"lead\">{} runs of {} sequences, {}</p>\n", set.records().size(),
                      set.sequences().size(), escaped(options.date));
  for (const std::string& one : options.warnings) text += warning(one);
  if (failed > 0) {
    text +=
        warning(fmt::format("{} of the runs failed; they stand in the last table with the "
                            "reason and count in no figure.",
                            failed));
  }
  if (too_few_runs(set)) {
    text += warning(
        fmt::format("Some figures are of fewer than {} runs: a trial, no result.", runs_wanted));
  }
  HtmlTable about({"", ""}, 2);
  about.add({"program", all_of(set, [](const RunRecord& r) { return r.version; })});
  about.add({"its fingerprint", all_of(set, [](const RunRecord& r) { return r.program; })});
  about.add({"machine", all_of(set, [](const RunRecord& r) { return r.machine; })});
  const std::string models = all_of(set, [](const RunRecord& r) { return r.model; });
  about.add({"detectors", all_of(set, [](const RunRecord& r) { return r.detector; }) +
                              (models.empty() ? "" : " (" + models + ")")});
  text += about.text();
  text +=
      "<nav><a href=\"#overview\">Overview</a><a href=\"#paper\">Tables 2 to 5</a><a "
      "href=\"#ablation\">Ablation</a><a href=\"#times\">Times</a><a "
      "href=\"#figures\">Paths</a><a href=\"#runs\">Every run</a></nav>\n";
  return text;
}

std::string paper_section(const RecordSet& set) {
  const std::string tables = paper_tables(set);
  std::string text = html_heading("Beside published figures (Tables 2 to 5)", "paper");
  if (tables.empty()) {
    return text + html_paragraph(
                      "None of the sequences is one of the paper's six (fr3 walking_halfsphere, "
                      "walking_rpy, walking_static, walking_xyz, sitting_static, sitting_xyz) or a "
                      "synthetic twin of one.");
  }
  return text +
         html_paragraph(
             "Published figures are of the TUM recordings. Rows \"on synthetic twins\" are of "
             "generated sequences with the same kind of motion: another room and other people, so "
             "they show how the modes compare with each other, not with other systems.") +
         tables;
}

}  // namespace

std::string bench_report(const std::vector<RunRecord>& records, const BenchReportOptions& options) {
  const RecordSet set(latest_records(records));
  std::string body = head(set, options);
  if (set.records().empty()) {
    return html_page("dkp-slam: bench", body + html_paragraph("There is no result yet."));
  }
  body += html_heading("Overview", "overview");
  body += html_paragraph(
      "Medians over the seeds; below them, small, the smallest and the largest where they differ. "
      "ATE: RMSE after "
      "rigid alignment without scale. RPE: RMSE of the drift over one second and from frame to "
      "frame. Lost: frames without a pose. Removed: share of the features.");
  body += overview_table(set);
  body += paper_section(set) + ablation_section(set) + times_section(set);
  body += figures_section(set, options.runs) + every_run_table(set);
  body +=
      "<footer>Made by dkp-slam bench. Figures of other systems: DKP-SLAM paper, Tables 2 to 8, "
      "and the papers named beside them.</footer>\n";
  return html_page("dkp-slam: bench", body);
}

}  // namespace dkp_slam
