#include "bench/results/report.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/results/markdown.h"
#include "bench/results/targets.h"
#include "dkp_slam/evaluation/report/published.h"

namespace dkp_slam::bench {
namespace {

// Below three runs a median says little; the goals are stated for three or more.
constexpr std::size_t runs_wanted = 3;
// Other programs at more than this share of the machine slow the measured one down.
constexpr double share_that_disturbs = 0.05;

bool is_share(Quantity quantity) {
  return quantity == Quantity::mask_iou || quantity == Quantity::features_removed ||
         quantity == Quantity::features_kept;
}

std::string shown(const std::optional<double>& value, Quantity quantity, int metre_decimals) {
  if (quantity == Quantity::mask_iou) return number(value, 3);
  if (is_share(quantity)) return percent(value);
  if (quantity == Quantity::frame_ms || quantity == Quantity::without_detection_ms) {
    return value ? number(value, 1) + " ms" : "-";
  }
  if (quantity == Quantity::peak_memory) return value ? number(value, 0) + " MB" : "-";
  return number(value, metre_decimals);
}

std::string shown(const Bound& bound, Quantity quantity) {
  return (bound.side == Bound::Side::at_most ? "<= " : ">= ") + shown(bound.limit, quantity, 4);
}

std::string shown(Verdict verdict) {
  if (verdict == Verdict::not_measured) return "-";
  return verdict == Verdict::pass ? "pass" : "**fail**";
}

std::vector<std::string> target_row(const Target& target, const Results& results) {
  const Standing standing = stand(target, results);
  std::string measured = shown(standing.value, target.quantity, 5), runs;
  for (const double run : standing.runs) {
    runs += (runs.empty() ? "" : ", ") + shown(run, target.quantity, 5);
  }
  if (standing.failed_runs > 0) runs += fmt::format(" ({} failed)", standing.failed_runs);
  if (target.all_localised && standing.lost_frames > 0) {
    runs += fmt::format(" (up to {} frames lost)", standing.lost_frames);
  }
  const bool worst = target.sequence.empty() && !standing.sequence.empty();
  return {target.what,
          worst                     ? standing.sequence + " (the worst)"
          : target.sequence.empty() ? "all"
                                    : target.sequence,
          target.mode,
          shown(target.must, target.quantity),
          target.aim ? shown(*target.aim, target.quantity) : "",
          measured,
          shown(standing.must),
          target.aim ? shown(standing.aim) : "",
          runs};
}

/// "0.0104", the median of a quantity over the runs.
std::string cell(const Results& results, const std::string& sequence, const std::string& mode,
                 Quantity quantity, int decimals) {
  return number(median_of(values(results, sequence, mode, quantity)), decimals);
}

std::string drift_table(const ReportHeader& header, const Results& results) {
  std::vector<std::string> columns{"mode"};
  for (const std::string& sequence : header.sequences) {
    columns.insert(columns.end(), {sequence + " m/s", "m/frame", "deg/s"});
  }
  MarkdownTable table(columns);
  for (const std::string& mode : header.modes) {
    std::vector<std::string> row{mode};
    for (const std::string& sequence : header.sequences) {
      row.push_back(cell(results, sequence, mode, Quantity::rpe_second, 4));
      row.push_back(cell(results, sequence, mode, Quantity::rpe_frame, 4));
      row.push_back(cell(results, sequence, mode, Quantity::rpe_degrees, 3));
    }
    table.add(row);
  }
  return table.text();
}

std::string times_table(const ReportHeader& header, const Results& results) {
  MarkdownTable table(
      {"sequence", "mode", "A detection", "B clustering", "C removal", "tracking", "features",
       "decoding", "frame in all", "without detection", "wall per frame", "processor per frame"},
      2);
  for (const std::string& sequence : header.sequences) {
    for (const std::string& mode : header.modes) {
      std::vector<std::string> row{sequence, mode};
      for (const char* stage :
           {"detection", "clustering", "removal", "tracking", "features", "decode", "frame"}) {
        row.push_back(number(median_of(stage_values(results, sequence, mode, stage)), 2));
      }
      row.push_back(cell(results, sequence, mode, Quantity::without_detection_ms, 2));
      row.push_back(cell(results, sequence, mode, Quantity::wall_ms, 1));
      row.push_back(cell(results, sequence, mode, Quantity::processor_ms, 1));
      table.add(row);
    }
  }
  return table.text();
}

std::string published_text(const PublishedTable& published) {
  MarkdownTable table(published.header);
  for (const auto& row : published.rows) table.add(row);
  return fmt::format("## {}\n\n{}\n\n{}", published.title, published.source, table.text());
}

/// Our own rows above those of other systems.
std::string same_data_text(const ReportHeader& header, const Results& results) {
  const PublishedTable& published = published_on_same_data();
  MarkdownTable table(published.header);
  for (const std::string& mode : header.modes) {
    std::vector<std::string> row{"dkp-slam " + mode + ", median"};
    std::optional<double> slowest;
    for (std::size_t c = 1; c + 1 < published.header.size(); ++c) {
      const std::string& sequence = published.header[c];
      row.push_back(cell(results, sequence, mode, Quantity::ate, 4));
      const auto ms = median_of(values(results, sequence, mode, Quantity::without_detection_ms));
      if (ms) slowest = std::max(slowest.value_or(0.0), *ms);
    }
    row.push_back(slowest ? fmt::format("median {:.1f} ms (the slowest)", *slowest) : "-");
    table.add(row);
  }
  for (const auto& row : published.rows) table.add(row);
  return fmt::format("## {}\n\n{}\n\n{}", published.title, published.source, table.text());
}

std::string every_run(const Results& results) {
  MarkdownTable table({"sequence", "mode", "seed", "frames", "lost", "ATE RMSE", "S.D.", "RPE m/s",
                       "frame ms", "memory MB", "wall s", "processor s", "others", "problem"},
                      2);
  for (const RunFigures& run : results.runs) {
    const bool good = run.problem.empty();
    const auto frame = run.stage_ms.find("frame");
    table.add({run.key.sequence, run.key.mode, std::to_string(run.key.seed),
               good ? std::to_string(run.frames) : "-",
               good ? std::to_string(run.lost_frames) : "-", good ? number(run.ate_rmse, 5) : "-",
               good ? number(run.ate_deviation, 5) : "-", number(run.rpe_second, 5),
               !run.whole || frame == run.stage_ms.end() ? "-" : number(frame->second, 1),
               good && run.whole ? number(run.peak_memory_mb, 0) : "-", number(run.wall_s, 1),
               number(run.processor_s, 1), percent(run.others_share), run.problem});
  }
  return table.text();
}

std::string masks_table(const Results& results) {
  MarkdownTable table(
      {"sequence", "mode", "seed", "frames scored", "mean IoU", "dynamic removed", "static kept"},
      2);
  for (const MaskFigures& masks : results.masks) {
    table.add({masks.key.sequence, masks.key.mode, std::to_string(masks.key.seed),
               std::to_string(masks.scored_frames), number(masks.iou, 4), percent(masks.removed),
               percent(masks.kept)});
  }
  return table.empty() ? "" : table.text();
}

std::string head(const ReportHeader& header, const Results& results) {
  double others = 0.0;
  for (const RunFigures& run : results.runs) others = std::max(others, run.others_share);
  std::string out = "# Results\n\nMade by `dkp-slam-results`; do not edit by hand.\n\n";
  out += fmt::format("- Date: {}\n- Version: {}\n- Command: `{}`\n", header.date,
                     header.machine.version, header.command);
  out += fmt::format("- Machine: {}, {} of memory, no GPU used; {}; {}\n", header.machine.processor,
                     header.machine.memory, header.machine.system, header.machine.compiler);
  out += fmt::format(
      "- Runs: one at a time, offline, {} of each sequence and mode, seeds {}. Figures are medians "
      "of them. Seed 1 runs with the detector, and once more on what it detected, with the same "
      "path to the byte; the others on what it detected: frame in all, detection, wall and "
      "processor time and memory are of seed 1.\n- Detector: {}\n",
      header.seeds.size(), fmt::join(header.seeds, ", "), header.detector);
  if (header.seeds.size() < runs_wanted) {
    out += fmt::format("- **Fewer than {} runs: a trial, no result.**\n", runs_wanted);
  }
  if (!header.complete) out += "- **Interrupted: only what was measured until then.**\n";
  if (others > share_that_disturbs) {
    out += fmt::format(
        "- **Machine under load: other programs took up to {} of the processor time during a run. "
        "The times are not to be trusted.**\n",
        percent(others));
  }
  return out + '\n';
}

}  // namespace

std::string targets_table(const Results& results) {
  MarkdownTable table(
      {"what", "sequence", "mode", "must", "aim", "measured", "must held", "aim held", "runs"}, 3);
  for (const Target& target : targets()) table.add(target_row(target, results));
  return table.text();
}

std::string ablation_table(const std::vector<std::string>& sequences,
                           const std::vector<std::string>& modes, const Results& results) {
  std::vector<std::string> columns{"mode"};
  for (const std::string& sequence : sequences) {
    columns.insert(columns.end(), {sequence + " RMSE", "S.D.", "lost"});
  }
  MarkdownTable table(columns);
  for (const std::string& mode : modes) {
    std::vector<std::string> row{mode};
    for (const std::string& sequence : sequences) {
      row.push_back(cell(results, sequence, mode, Quantity::ate, 4));
      row.push_back(cell(results, sequence, mode, Quantity::ate_deviation, 4));
      row.push_back(cell(results, sequence, mode, Quantity::lost_frames, 0));
    }
    table.add(row);
  }
  return table.text();
}

std::string report(const ReportHeader& header, const Results& results) {
  std::string out = head(header, results);
  out +=
      "## Goals\n\nATE: RMSE in metres after rigid alignment. A frame is lost when the "
      "trajectory has no pose for it. Masks and features are scored against mask/: frames with a "
      "person over 5 % of the image, each true region against the masks that touch it; a feature "
      "counts as removed when it is called not static. Tracking without detection: features, "
      "clustering, removal and tracking of a frame, one after the other, in a second run that "
      "reads the first one's detections from a file, one frame at a time, so that neither a "
      "network nor the next frame shares the cores; with "
      "mode off it is what ORB-SLAM3 calls tracking. Memory: VmHWM, MB of 1024 x 1024 bytes.\n\n";
  out += targets_table(results) + '\n';
  out +=
      "## Ablation (as the paper's Table 6)\n\nATE in metres: RMSE and standard deviation; frames "
      "lost, which do not count in it.\n\n";
  out += ablation_table(header.sequences, header.modes, results) + '\n';
  out +=
      "## Drift\n\nRPE, RMSE: translation over one second and from frame to frame, rotation over "
      "one second.\n\n";
  out += drift_table(header, results) + '\n';
  out +=
      "## Times (as the paper's Table 7)\n\nMilliseconds, medians over all frames, also those "
      "without a person. Decoding, features and detection run in their own threads ahead of the "
      "rest, so the frame in all is less than the sum. Wall and processor time per frame are the "
      "whole process's, with its start and the final adjustment, divided by its frames.\n\n";
  out += times_table(header, results) + '\n';
  out += published_text(published_times()) + '\n';
  out += same_data_text(header, results) + '\n';
  for (const PublishedTable& table : published_elsewhere()) out += published_text(table) + '\n';
  out +=
      "## Every run\n\nOthers: the share of the machine's processor time that other programs "
      "took meanwhile. Without a frame time: on the detections of seed 1.\n\n" +
      every_run(results);
  if (const std::string masks = masks_table(results); !masks.empty()) out += '\n' + masks;
  return out;
}

}  // namespace dkp_slam::bench
