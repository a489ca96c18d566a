#include "dkp_slam/evaluation/report/page_charts.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/evaluation/axes.h"

namespace dkp_slam {
namespace {

using nlohmann::json;

// Digits after the point: more would make the page longer and say nothing.
constexpr int time_digits = 3, place_digits = 4, error_digits = 6, value_digits = 3;
constexpr double estimate_width = 1.5, truth_width = 2.2;

double rounded(double value, int digits) {
  const double factor = std::pow(10.0, digits);
  return std::round(value * factor) / factor;
}

std::string hexadecimal(const Colour& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

/// An element with the data in it. What could end the element or begin another is written so that
/// only JSON reads it; bytes that are no UTF-8 become the sign for that.
std::string chart_element(const json& chart) {
  std::string text;
  for (const char c : chart.dump(-1, ' ', false, json::error_handler_t::replace)) {
    if (c == '<' || c == '>' || c == '&') {
      text += fmt::format("\\u{:04x}", static_cast<int>(c));
    } else {
      text += c;
    }
  }
  return "<div class=\"chart\"><script type=\"application/json\">" + text + "</script></div>\n";
}

json path_series(const std::string& name, const Colour& colour, double width,
                 std::span<const StampedPose> poses, const Se3& truth_from_world, double start) {
  json series{{"name", name}, {"colour", hexadecimal(colour)}, {"width", width}};
  for (const char* list : {"t", "x", "y", "z"}) series[list] = json::array();
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d at = truth_from_world * pose.world_from_camera.translation;
    series["t"].push_back(rounded(pose.timestamp - start, time_digits));
    series["x"].push_back(rounded(at.x(), place_digits));
    series["y"].push_back(rounded(at.y(), place_digits));
    series["z"].push_back(rounded(at.z(), place_digits));
  }
  return series;
}

}  // namespace

std::string path_chart(std::span<const StampedPose> truth, std::span<const ScoredPath> paths,
                       const AssociationOptions& association) {
  if (paths.empty()) return "";
  const Trajectory during = truth_during(truth, paths, association);
  if (during.empty()) return "";
  const double start = start_of(paths);
  json chart{{"kind", "paths"}, {"title", "Path"}};
  chart["series"].push_back(path_series("true path", chart::truth_colour, truth_width, during,
                                        Se3(), start + association.offset));
  for (const ScoredPath& path : paths) {
    chart["series"].push_back(path_series(path.name, path.colour, estimate_width, path.estimate,
                                          path.error.truth_from_estimate, start));
  }
  return chart_element(chart);
}

std::string error_chart(const std::string& title, std::span<const ErrorSeries> series) {
  if (series.empty()) return "";
  json chart{{"kind", "errors"}, {"title", title}};
  for (const ErrorSeries& one : series) {
    json errors{{"name", one.name}, {"colour", hexadecimal(one.colour)}};
    for (const double time : one.times) errors["t"].push_back(rounded(time, time_digits));
    for (const double error : one.errors) errors["error"].push_back(rounded(error, error_digits));
    chart["series"].push_back(std::move(errors));
  }
  return chart_element(chart);
}

std::string error_chart(std::span<const ScoredPath> paths) {
  std::vector<ErrorSeries> series;
  for (const ScoredPath& path : paths) {
    series.push_back({path.name, path.colour, {}, path.error.errors});
    for (const PoseMatch& match : path.error.matches) {
      series.back().times.push_back(path.estimate[match.estimate].timestamp - start_of(paths));
    }
  }
  return error_chart("Distance from the true path", series);
}

std::string histogram_chart(const std::string& title, std::span<const FrameValues> series,
                            const std::string& quantity, const std::string& unit) {
  json chart{{"kind", "histogram"}, {"title", title}, {"x", quantity}, {"unit", unit}};
  chart["series"] = json::array();
  for (const FrameValues& one : series) {
    json values{{"name", one.name}, {"colour", hexadecimal(one.colour)}};
    values["values"] = json::array();
    for (const double value : one.values) values["values"].push_back(rounded(value, value_digits));
    chart["series"].push_back(std::move(values));
  }
  return chart_element(chart);
}

std::string chart_help() {
  return "Drag over a chart, or turn the wheel with Ctrl, to zoom; double click for all of it. The "
         "names below switch the lines on and off.";
}

}  // namespace dkp_slam
