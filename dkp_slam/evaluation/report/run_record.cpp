#include "dkp_slam/evaluation/report/run_record.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <fstream>
#include <tuple>

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/sequence_name.h"
#include "dkp_slam/evaluation/report/published.h"
#include "dkp_slam/json_integer.h"
#include "dkp_slam/json_text.h"

namespace dkp_slam {
namespace {

using Json = nlohmann::ordered_json;

void put(Json& json, const char* name, const std::optional<double>& value) {
  json[name] = value ? Json(*value) : Json(nullptr);
}

std::optional<double> optional_number(const Json& json, const char* name) {
  const Json& value = json.at(name);
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

/// Whether a name is one component of a path, and no way out of a folder.
bool is_component(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos &&
         name.find('\0') == std::string::npos;
}

bool contains(const std::vector<std::string>& all, const std::string& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

std::ptrdiff_t place_in(const std::vector<std::string>& all, const std::string& one) {
  return std::find(all.begin(), all.end(), one) - all.begin();
}

auto order_of(const RunRecord& r) {
  const auto paper = paper_sequence(r.sequence, r.scenario);
  const std::ptrdiff_t place = place_in(paper_sequences(), paper ? paper->name : "");
  return std::tuple(place, paper && paper->synthetic, r.sequence, place_in(bench_modes(), r.mode),
                    place_in(bench_detectors(), r.detector), r.model, r.seed);
}

/// A file that is open and locked for adding to it.
class AppendedFile {
 public:
  explicit AppendedFile(const std::filesystem::path& path)
      : path_(path), file_(::open(path.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0644)) {
    if (file_ < 0) fail();
    // Where a file system knows no locks, adding in one write is all that can be done.
    while (::flock(file_, LOCK_EX) != 0 && errno == EINTR) {
    }
  }
  ~AppendedFile() { ::close(file_); }
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;

  /// Whether the last write before was cut off.
  bool ends_within_a_line() const {
    const off_t end = ::lseek(file_, 0, SEEK_END);
    char last = '\n';
    return end > 0 && ::pread(file_, &last, 1, end - 1) == 1 && last != '\n';
  }
  void add(const std::string& text) const {
    const ssize_t written = ::write(file_, text.data(), text.size());
    if (written < 0) fail();
    if (static_cast<std::size_t>(written) != text.size()) {
      throw Error(path_.string() + ": cannot be written to its end; is the disk full?");
    }
  }

 private:
  [[noreturn]] void fail() const {
    throw Error(fmt::format("{}: cannot add a result: {}; choose another --out", path_.string(),
                            std::strerror(errno)));
  }

  const std::filesystem::path path_;
  const int file_;
};

}  // namespace

const std::vector<std::string>& bench_modes() {
  static const std::vector<std::string> modes = [] {
    std::vector<std::string> names;
    for (const ModeInfo& mode : dynamics_modes()) names.emplace_back(mode.name);
    return names;
  }();
  return modes;
}

const std::vector<std::string>& bench_detectors() {
  static const std::vector<std::string> detectors{"none", "motion", "boxes", "yolox"};
  return detectors;
}

std::string run_name(const RunRecord& r) {
  return fmt::format("{}/{}-{}{}/seed{}", r.sequence, r.mode, r.detector,
                     r.model.empty() ? "" : "-" + r.model, r.seed);
}

std::string to_json_line(const RunRecord& r) {
  Json json;
  json["sequence"] = r.sequence;
  json["scenario"] = r.scenario;
  json["mode"] = r.mode;
  json["detector"] = r.detector;
  json["model"] = r.model;
  json["seed"] = r.seed;
  json["exit_code"] = r.exit_code;
  json["problem"] = r.problem;
  json["frames"] = r.frames;
  json["lost"] = r.lost;
  json["ate_m"] = r.ate_m;
  json["ate_deviation_m"] = r.ate_deviation_m;
  put(json, "rpe_s_m", r.rpe_s_m);
  put(json, "rpe_s_deg", r.rpe_s_deg);
  put(json, "rpe_frame_m", r.rpe_frame_m);
  put(json, "rpe_frame_deg", r.rpe_frame_deg);
  json["features"] = r.features;
  json["removed"] = r.removed;
  json["keyframes"] = r.keyframes;
  json["landmarks"] = r.landmarks;
  json["loops_closed"] = r.loops_closed;
  json["maps_joined"] = r.maps_joined;
  json["maps"] = r.maps;
  json["stage_ms"] = r.stage_ms;
  json["total_s"] = r.total_s;
  json["processor_s"] = r.processor_s;
  json["others_share"] = r.others_share;
  json["peak_memory_mb"] = r.peak_memory_mb;
  json["jobs"] = r.jobs;
  json["version"] = r.version;
  json["program"] = r.program;
  json["options"] = r.options;
  json["machine"] = r.machine;
  json["date"] = r.date;
  // A file name that is not UTF-8 must not cost the user the figures.
  return json_text(json, -1);
}

RunRecord parse_json_line(const std::string& line) {
  RunRecord r;
  try {
    const Json json = Json::parse(line);
    r.sequence = json.at("sequence");
    r.scenario = json.at("scenario");
    r.mode = json.at("mode");
    r.detector = json.at("detector");
    r.model = json.at("model");
    r.seed = integer_at<std::uint64_t>(json, "seed");
    r.exit_code = integer_at<int>(json, "exit_code");
    r.problem = json.at("problem");
    r.frames = integer_at<std::size_t>(json, "frames");
    r.lost = integer_at<std::size_t>(json, "lost");
    r.ate_m = json.at("ate_m");
    r.ate_deviation_m = json.at("ate_deviation_m");
    r.rpe_s_m = optional_number(json, "rpe_s_m");
    r.rpe_s_deg = optional_number(json, "rpe_s_deg");
    r.rpe_frame_m = optional_number(json, "rpe_frame_m");
    r.rpe_frame_deg = optional_number(json, "rpe_frame_deg");
    r.features = integer_at<std::size_t>(json, "features");
    r.removed = integer_at<std::size_t>(json, "removed");
    r.keyframes = integer_at<std::size_t>(json, "keyframes");
    r.landmarks = integer_at<std::size_t>(json, "landmarks");
    r.loops_closed = integer_at<std::size_t>(json, "loops_closed");
    r.maps_joined = integer_at<std::size_t>(json, "maps_joined");
    r.maps = integer_at<std::size_t>(json, "maps");
    r.stage_ms = json.at("stage_ms").get<std::map<std::string, double>>();
    r.total_s = json.at("total_s");
    r.processor_s = json.at("processor_s");
    r.others_share = json.at("others_share");
    r.peak_memory_mb = json.at("peak_memory_mb");
    r.jobs = integer_at<int>(json, "jobs");
    r.version = json.at("version");
    r.program = json.at("program");
    r.options = json.at("options");
    r.machine = json.at("machine");
    r.date = json.at("date");
  } catch (const std::exception& error) {
    throw Error(fmt::format("not a result of dkp-slam bench: {}", error.what()));
  }
  const bool safe = is_component(r.sequence) && (r.model.empty() || is_component(r.model));
  if (!safe || !contains(bench_modes(), r.mode) || !contains(bench_detectors(), r.detector)) {
    throw Error("not a result of dkp-slam bench: sequence, mode or detector make no sense");
  }
  return r;
}

std::vector<RunRecord> read_records(const std::filesystem::path& path) {
  std::vector<RunRecord> records;
  std::ifstream in(path);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty()) continue;
    try {
      records.push_back(parse_json_line(line));
    } catch (const Error& error) {
      spdlog::warn("{}:{}: {}; left out", path.string(), number, error.what());
    }
  }
  return records;
}

void append_record(const std::filesystem::path& path, const RunRecord& record) {
  const AppendedFile file(path);
  std::string line = to_json_line(record) + '\n';
  if (file.ends_within_a_line()) line.insert(line.begin(), '\n');
  file.add(line);
}

std::vector<RunRecord> latest_records(const std::vector<RunRecord>& records) {
  std::map<std::string, RunRecord> latest;
  for (const RunRecord& record : records) {
    const auto [at, added] = latest.emplace(run_name(record), record);
    // Of records made in the same second the one that stands later.
    if (!added && at->second.date <= record.date) at->second = record;
  }
  std::vector<RunRecord> result;
  for (const auto& [name, record] : latest) result.push_back(record);
  std::stable_sort(result.begin(), result.end(), [](const RunRecord& a, const RunRecord& b) {
    return order_of(a) < order_of(b);
  });
  return result;
}

}  // namespace dkp_slam
