#include "apps/run_summary.h"

#include <cstdint>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/input_file.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t most_bytes = 10'000'000;

/// Null where there is none.
json field_of(const json& object, const char* name) {
  return object.is_object() ? object.value(name, json()) : json();
}

std::string text_in(const json& object, const char* name) {
  const json field = field_of(object, name);
  return field.is_string() ? field.get<std::string>() : "";
}

/// Whole, from 0 to what a double counts exactly.
std::size_t count_in(const json& summary, const char* name) {
  constexpr std::uint64_t most = std::uint64_t{1} << 53U;
  const json field = field_of(summary, name);
  if (!field.is_number_unsigned() || field.get<std::uint64_t>() > most) {
    throw Error(fmt::format("{} is no count", name));
  }
  return field.get<std::size_t>();
}

double number_in(const json& object, const std::string& name) {
  const json field = field_of(object, name.c_str());
  if (!field.is_number()) throw Error(name + " is no number");
  return field.get<double>();
}

json parsed(const std::string& text) { return json::parse(text, nullptr, false); }

RunInput input_in(const json& summary) {
  const json options = field_of(summary, "options");
  RunInput input;
  input.sequence = text_in(options, "sequence");
  input.topics = text_in(options, "topics");
  input.camera = text_in(options, "camera");
  input.model = text_in(options, "model");
  if (const json rate = field_of(options, "frame_rate"); rate.is_number()) {
    input.frame_rate = rate.get<double>();
  }
  return input;
}

fs::path summary_of(const fs::path& run) { return run / "summary.json"; }

std::string content_of(const fs::path& file) {
  std::ifstream stream = open_text(file, most_bytes, "cannot be read", "run it again");
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace

RunInput parse_run_input(const std::string& text) { return input_in(parsed(text)); }

RunSummary parse_run_summary(const std::string& text) {
  const json summary = parsed(text);
  if (!summary.is_object()) throw Error("is no JSON object");
  RunSummary run;
  run.input = input_in(summary);
  run.detector = text_in(summary, "detector");
  run.frames = count_in(summary, "frames");
  run.skipped_frames = count_in(summary, "skipped_frames");
  run.features = count_in(summary, "features");
  run.features_removed = count_in(summary, "features_removed");
  run.keyframes = count_in(summary, "keyframes");
  run.landmarks = count_in(summary, "landmarks");
  run.loops_closed = count_in(summary, "loops_closed");
  run.maps_joined = count_in(summary, "maps_joined");
  run.maps = field_of(summary, "maps").size();
  run.peak_memory_mb = number_in(summary, "peak_memory_mb");
  const json medians = field_of(summary, "median_ms");
  if (!medians.is_object()) throw Error("median_ms is no JSON object");
  for (const auto& stage : medians.items()) {
    run.median_ms[stage.key()] = number_in(medians, stage.key());
  }
  return run;
}

RunSummary read_run_summary(const fs::path& run) {
  const fs::path file = summary_of(run);
  const std::string text = content_of(file);
  try {
    return parse_run_summary(text);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}; run it again", file.string(), error.what()));
  }
}

RunInput read_run_input(const fs::path& run) {
  const fs::path file = summary_of(run);
  if (!why_unreadable(file, most_bytes).empty()) return {};
  return parse_run_input(content_of(file));
}

}  // namespace dkp_slam::apps
