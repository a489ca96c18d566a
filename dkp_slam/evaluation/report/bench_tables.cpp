#include "dkp_slam/evaluation/report/bench_tables.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/evaluation/measure/sequence_name.h"
#include "dkp_slam/evaluation/report/published.h"

namespace dkp_slam {
namespace {

using Quantity = std::function<std::optional<double>(const RunRecord&)>;
using Runs = std::vector<const RunRecord*>;

constexpr int metre_decimals = 4;
// Other programs at more than this share of the machine slow a run down.
constexpr double share_that_disturbs = 0.05;

std::optional<double> ate(const RunRecord& r) { return r.ate_m; }
std::optional<double> ate_deviation(const RunRecord& r) { return r.ate_deviation_m; }
std::optional<double> rpe_second(const RunRecord& r) { return r.rpe_s_m; }
std::optional<double> rpe_frame(const RunRecord& r) { return r.rpe_frame_m; }

Quantity stage(const std::string& name) {
  return [name](const RunRecord& r) -> std::optional<double> {
    const auto found = r.stage_ms.find(name);
    return found == r.stage_ms.end() ? std::nullopt : std::optional(found->second);
  };
}

std::optional<double> removed_percent(const RunRecord& r) {
  if (r.features == 0) return std::nullopt;
  return 100.0 * static_cast<double>(r.removed) / static_cast<double>(r.features);
}

HtmlCell cell(const Runs& runs, const Quantity& quantity, int decimals) {
  return spread_cell(values_of(runs, quantity), decimals);
}

/// "walking_xyz" and, small, what it is in the paper.
HtmlCell sequence_cell(const Runs& runs, const std::string& sequence) {
  if (runs.empty()) return sequence;
  const auto paper = paper_sequence(sequence, runs.front()->scenario);
  if (!paper) {
    const std::string& scenario = runs.front()->scenario;
    return {sequence, scenario.empty() ? "" : "generated: " + scenario};
  }
  return {sequence, paper->synthetic ? "synthetic twin of " + paper->name : paper->name};
}

/// Ours in the columns of a published table; nothing where none of its sequences was run.
std::optional<std::vector<HtmlCell>> paper_row(const RecordSet& set, const BenchConfig& config,
                                               bool synthetic, const Quantity& quantity,
                                               const std::string& what) {
  std::vector<HtmlCell> row{{fmt::format("dkp-slam {}{}", set.label(config), what),
                             synthetic ? "on synthetic twins" : "on the recordings, fr3"}};
  bool any = false;
  for (const std::string& name : paper_sequences()) {
    const Runs runs = set.paper_runs(name, synthetic, config);
    any = any || !runs.empty();
    row.push_back(cell(runs, quantity, metre_decimals));
  }
  return any ? std::optional(row) : std::nullopt;
}

/// The configurations that stand beside other systems: no half-built ones.
std::vector<BenchConfig> compared_configs(const RecordSet& set) {
  std::vector<BenchConfig> compared;
  for (const BenchConfig& config : set.configs()) {
    if (config.mode == "off" || config.mode == "dkp") compared.push_back(config);
  }
  for (const BenchConfig& config : set.best_configs()) {
    if (std::find(compared.begin(), compared.end(), config) == compared.end()) {
      compared.push_back(config);
    }
  }
  return compared;
}

/// One of the paper's tables with our rows; nothing where we have none.
std::string paper_table(const RecordSet& set, const PublishedTable& published,
                        const std::vector<std::pair<std::string, Quantity>>& quantities) {
  HtmlTable table(published.header);
  for (const auto& row : published.rows) {
    table.add({row.begin(), row.end()}, HtmlRow::published);
  }
  bool any = false;
  const std::string best = set.configs().back().mode;
  for (const bool synthetic : {false, true}) {
    for (const BenchConfig& config : compared_configs(set)) {
      for (const auto& [what, quantity] : quantities) {
        const auto row = paper_row(set, config, synthetic, quantity, what);
        if (!row) continue;
        any = true;
        table.add(*row, config.mode == best ? HtmlRow::ours : HtmlRow::plain);
      }
    }
  }
  if (!any) return "";
  return "<h3>" + escaped(published.title) + "</h3>\n" + html_paragraph(published.source) +
         table.text();
}

/// The paper's figure of a mode on a sequence, column 0 RMSE, 1 S.D.; empty where it has none.
std::string published_ablation_figure(const std::string& mode, const std::string& paper_name,
                                      std::size_t column) {
  const auto& names = paper_sequences();
  const auto place =
      static_cast<std::size_t>(std::find(names.begin(), names.end(), paper_name) - names.begin());
  if (place == names.size()) return "";
  for (const auto& row : published_ablation().rows) {
    if (row.front() == mode) return row.at(1 + 2 * place + column);
  }
  return "";
}

void add_ablation_rows(const RecordSet& set, const std::string& sequence, HtmlTable& table) {
  bool first = true;
  for (const BenchConfig& config : set.configs()) {
    const Runs runs = set.runs(sequence, config);
    if (runs.empty()) continue;
    const auto paper = paper_sequence(sequence, runs.front()->scenario);
    const std::string name = paper ? paper->name : "";
    std::size_t lost = 0;
    for (const RunRecord* run : runs) lost = std::max(lost, run->lost);
    table.add({first ? sequence_cell(runs, sequence) : HtmlCell(), set.label(config),
               cell(runs, ate, metre_decimals), cell(runs, ate_deviation, metre_decimals),
               std::to_string(lost), published_ablation_figure(config.mode, name, 0),
               published_ablation_figure(config.mode, name, 1)},
              config.mode == set.configs().back().mode ? HtmlRow::ours : HtmlRow::plain);
    first = false;
  }
}

/// Says why times are not to be trusted; empty where nothing speaks against them.
std::string times_warning(const RecordSet& set) {
  int jobs = 1;
  double others = 0.0;
  for (const RunRecord& run : set.records()) {
    jobs = std::max(jobs, run.jobs);
    others = std::max(others, run.others_share);
  }
  std::string text;
  if (jobs > 1) {
    text = fmt::format("Up to {} runs shared the machine.", jobs);
  } else if (others > share_that_disturbs) {
    text = fmt::format("Other programs took up to {:.0f} % of the machine during a run.",
                       100.0 * others);
  }
  if (text.empty()) return "";
  return "<p class=\"warning\">" + text +
         " The times are not to be quoted: for that, run the bench with --jobs 1 and nothing "
         "beside it.</p>\n";
}

}  // namespace

std::string overview_table(const RecordSet& set) {
  HtmlTable table({"sequence", "mode, detector", "runs", "ATE [m]", "RPE 1 s [m]", "[deg]",
                   "RPE frame [m]", "[deg]", "lost", "removed [%]", "frame [ms]"},
                  2);
  for (const std::string& sequence : set.sequences()) {
    bool first = true;
    for (const BenchConfig& config : set.configs()) {
      const Runs runs = set.runs(sequence, config);
      if (runs.empty()) continue;
      table.add(
          {first ? sequence_cell(runs, sequence) : HtmlCell(), set.label(config),
           std::to_string(runs.size()), cell(runs, ate, metre_decimals),
           cell(runs, rpe_second, metre_decimals),
           cell(
               runs, [](const RunRecord& r) { return r.rpe_s_deg; }, 3),
           cell(runs, rpe_frame, metre_decimals),
           cell(
               runs, [](const RunRecord& r) { return r.rpe_frame_deg; }, 3),
           cell(
               runs, [](const RunRecord& r) { return std::optional(static_cast<double>(r.lost)); },
               0),
           cell(runs, removed_percent, 1), cell(runs, stage("frame"), 1)},
          config.mode == set.configs().back().mode ? HtmlRow::ours : HtmlRow::plain);
      first = false;
    }
  }
  return table.text();
}

std::string paper_tables(const RecordSet& set) {
  if (set.configs().empty()) return "";
  const std::vector<std::pair<std::string, Quantity>> ate_only{{"", ate}};
  const std::vector<std::pair<std::string, Quantity>> steps{{", over 1 s", rpe_second},
                                                            {", over 1 frame", rpe_frame}};
  return paper_table(set, published_ate_by_base(), ate_only) +
         paper_table(set, published_rpe_by_base(), steps) +
         paper_table(set, published_ate_of_others(), ate_only) +
         paper_table(set, published_rpe_of_others(), steps);
}

std::string ablation_section(const RecordSet& set) {
  HtmlTable table({"sequence", "mode, detector", "ATE RMSE [m]", "S.D. [m]", "most frames lost",
                   "the paper's RMSE", "S.D."},
                  2);
  for (const std::string& sequence : set.sequences()) add_ablation_rows(set, sequence, table);
  return html_heading("Ablation (Table 6)", "ablation") +
         html_paragraph(
             "Modes: off removes nothing; d removes all features in boxes, dk those in clustered "
             "masks, dkp is the paper's whole method, dkp+ the paper's, improved. The paper's "
             "figures (Table 6) are of the TUM recordings with YOLOX; beside a synthetic twin they "
             "are no direct comparison.") +
         table.text();
}

std::string times_section(const RecordSet& set) {
  HtmlTable modules({"system", "A detection", "B clustering", "C removal", "tracking", "features",
                     "decoding", "frame in all"});
  for (const auto& row : published_times().rows) {
    modules.add({row.begin(), row.end()}, HtmlRow::published);
  }
  HtmlTable systems(published_system_times().header, 1);
  for (const auto& row : published_system_times().rows) {
    systems.add({row.begin(), row.end()}, HtmlRow::published);
  }
  for (const BenchConfig& config : set.configs()) {
    const Runs runs = set.runs(config);
    if (runs.empty()) continue;
    const HtmlRow kind = config.mode == set.configs().back().mode ? HtmlRow::ours : HtmlRow::plain;
    const std::string name = "dkp-slam " + set.label(config);
    modules.add({name, cell(runs, stage("detection"), 2), cell(runs, stage("clustering"), 2),
                 cell(runs, stage("removal"), 2), cell(runs, stage("tracking"), 2),
                 cell(runs, stage("features"), 2), cell(runs, stage("decode"), 2),
                 cell(runs, stage("frame"), 2)},
                kind);
    systems.add({name, cell(runs, stage("frame"), 2), runs.front()->machine}, kind);
  }
  std::string text = html_heading("Times (Tables 7 and 8)", "times");
  text += html_paragraph(
      "Milliseconds per frame. Ours: medians over the frames of a run, then over runs and "
      "sequences, with the smallest and the largest below. Decoding, features and detection run in "
      "threads of their own ahead of the rest, so a frame in all takes less than the sum. " +
      published_times().source);
  text += times_warning(set);
  return text + "<h3>Table 7: time of the modules</h3>\n" + modules.text() +
         "<h3>Table 8: time of whole systems</h3>\n" +
         html_paragraph(published_system_times().source) + systems.text();
}

std::string every_run_table(const RecordSet& set) {
  HtmlTable table(
      {"sequence",    "mode, detector", "seed",        "frames",     "lost",  "ATE [m]", "S.D. [m]",
       "RPE 1 s [m]", "frame [ms]",     "keyframes",   "landmarks",  "loops", "joins",   "maps",
       "total [s]",   "processor [s]",  "memory [MB]", "others [%]", "date",  "problem"},
      2);
  for (const RunRecord& r : set.records()) {
    const Runs runs{&r};
    const auto number = [](double value, int decimals) {
      return fmt::format("{:.{}f}", value, decimals);
    };
    std::vector<HtmlCell> row{r.sequence, set.label(config_of(r)), std::to_string(r.seed)};
    if (r.problem.empty()) {
      row.insert(row.end(), {std::to_string(r.frames), std::to_string(r.lost), number(r.ate_m, 5),
                             number(r.ate_deviation_m, 5), cell(runs, rpe_second, 5),
                             cell(runs, stage("frame"), 1), std::to_string(r.keyframes),
                             std::to_string(r.landmarks), std::to_string(r.loops_closed),
                             std::to_string(r.maps_joined), std::to_string(r.maps)});
    } else {
      row.resize(row.size() + 11);
    }
    row.insert(row.end(),
               {number(r.total_s, 1), number(r.processor_s, 1), number(r.peak_memory_mb, 0),
                number(100.0 * r.others_share, 0), r.date, r.problem});
    table.add(row);
  }
  return html_heading("Every run", "runs") +
         html_paragraph(
             "Others: the share of the machine's processor time that other processes took "
             "meanwhile, other runs of this bench among them. Loops: closed within a map; joins: "
             "of "
             "two maps into one; maps: that frames were localised in and that never met.") +
         table.text();
}

}  // namespace dkp_slam
