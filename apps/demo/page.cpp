#include <array>

#include <fmt/format.h>

#include "apps/demo/demo.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/evaluation/report/html.h"
#include "dkp_slam/evaluation/report/page_charts.h"

namespace dkp_slam::apps {
namespace {

std::string card(const std::string& figure, const std::string& what) {
  return fmt::format("<div class=\"card\"><b>{}</b><span>{}</span></div>\n", escaped(figure),
                     escaped(what));
}

std::string cards(const DemoResult& result) {
  const auto millimetres = [](const DemoRun& run) {
    return fmt::format("{:.1f} mm", 1e3 * run.path.error.statistics.rmse);
  };
  return "<div class=\"cards\">\n" +
         card(millimetres(result.off), "error (ATE), mode off: nothing left out") +
         card(millimetres(result.best), "error (ATE), mode dkp+: people left out") +
         card(fmt::format("{:.0f} %", 100.0 * result.best.removed_share),
              "of the features removed") +
         card(result.yolox ? "YOLOX" : "motion",
              result.yolox ? "detector, " + result.model : "detector, needs no model") +
         "</div>\n";
}

std::string paths_section(const DemoResult& result) {
  const std::array<ScoredPath, 2> paths{result.off.path, result.best.path};
  return html_heading("The camera's path", "path") +
         html_figure({path_chart(result.truth, paths), error_chart(paths)},
                     "The true path and the two estimates, and their distance from the true path "
                     "over time. " +
                         chart_help());
}

std::string frames_section(const DemoResult& result) {
  std::string text = html_heading("What was removed", "frames");
  text += html_paragraph(
      "Dots are features, coloured by region: green low, blue suspicious, red high. Red areas are "
      "masks of what may move, boxes come from the detector (dashed: carried over a frame in which "
      "it missed them), crossed features were removed.");
  for (const DemoFrame& frame : result.frames) {
    text += html_figure(
        {html_image(data_uri(frame.off), fmt::format("frame {}, mode off", frame.index)),
         html_image(data_uri(frame.best), fmt::format("frame {}, mode dkp+", frame.index))},
        fmt::format("Frame {}. Left, mode off: every feature is used. Right, mode dkp+.",
                    frame.index));
  }
  return text;
}

void add_row(HtmlTable& table, const DemoRun& run, HtmlRow kind) {
  const ErrorStatistics& ate = run.path.error.statistics;
  table.add({"mode " + run.mode, run.detector, fmt::format("{:.4f}", ate.rmse),
             fmt::format("{:.4f}", ate.median), fmt::format("{:.4f}", ate.max),
             run.rpe_second_m > 0.0 ? fmt::format("{:.4f}", run.rpe_second_m) : std::string("-"),
             fmt::format("{} of {}", run.lost, run.frames),
             fmt::format("{:.1f}", 100.0 * run.removed_share), fmt::format("{:.1f}", run.frame_ms),
             fmt::format("{:.1f}", run.seconds)},
            kind);
}

std::string figures_section(const DemoResult& result) {
  HtmlTable table({"", "detector", "ATE [m]", "median [m]", "largest [m]", "RPE 1 s [m]",
                   "lost frames", "removed [%]", "frame [ms]", "total [s]"},
                  2);
  add_row(table, result.off, HtmlRow::plain);
  add_row(table, result.best, HtmlRow::ours);
  return html_heading("Figures", "figures") +
         html_paragraph(
             "ATE: distance from the true path after rigid alignment, RMSE. RPE: drift over one "
             "second, RMSE. Frame: median time between two finished frames, all stages together; "
             "the pictures above cost time, too.") +
         table.text();
}

std::string next_section(const DemoResult& result) {
  std::string text = html_heading("How it was made", "how");
  text += html_paragraph(fmt::format(
      "A generated room with people walking about: scenario {}, seed {}, {} frames, with the noise "
      "of a Kinect. Every position of the camera is known, so the errors are exact. Program: "
      "dkp-slam {}, on {}, {}.",
      result.scenario, result.options.seed, result.best.frames, result.version, result.machine,
      result.date));
  text += html_paragraph("Detector: " + detector_text(result) + ".");
  if (!result.yolox) text += html_paragraph("No YOLOX model was found: " + model_advice());
  return text;
}

}  // namespace

std::string demo_page(const DemoResult& result) {
  std::string body = "<h1>dkp-slam: demo</h1>\n";
  body += fmt::format(
      "<p class=\"lead\">The path of a camera through a room where people walk "
      "about, found twice: with everything in view, and with people left out. "
      "{}</p>\n",
      escaped(demo_finding(result)));
  body += cards(result) + paths_section(result) + figures_section(result) + frames_section(result) +
          next_section(result);
  return html_page("dkp-slam: demo", body);
}

}  // namespace dkp_slam::apps
