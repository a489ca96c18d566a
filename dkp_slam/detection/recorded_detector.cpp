#include "dkp_slam/detection/recorded_detector.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/input_file.h"

namespace dkp_slam {
namespace {

std::int64_t microseconds(double timestamp) { return std::llround(timestamp * 1e6); }

class RecordedDetector : public Detector {
 public:
  RecordedDetector(std::string name, std::map<std::int64_t, std::vector<Detection>> of_stamp,
                   std::set<std::int64_t> gaps)
      : name_(std::move(name)), of_stamp_(std::move(of_stamp)), gaps_(std::move(gaps)) {}

  std::string name() const override { return name_; }
  bool looks_at(const RgbdFrame& frame) override {
    return !gaps_.contains(microseconds(frame.timestamp));
  }
  std::vector<Detection> detect(const RgbdFrame& frame) override {
    const auto found = of_stamp_.find(microseconds(frame.timestamp));
    if (found == of_stamp_.end()) return {};
    std::vector<Detection> out;
    const cv::Rect2f image(0.0F, 0.0F, static_cast<float>(frame.colour.cols),
                           static_cast<float>(frame.colour.rows));
    for (Detection d : found->second) {
      d.box &= image;
      if (d.box.area() > 0.0F) out.push_back(d);
    }
    return out;
  }

 private:
  std::string name_;
  std::map<std::int64_t, std::vector<Detection>> of_stamp_;
  std::set<std::int64_t> gaps_;  // not looked at
};

constexpr const char* gap_words = " not looked at";

/// Time stamp of a line that recorded_gap wrote; nothing for other comments.
std::optional<double> gap_of(const std::string& line) {
  std::istringstream words(line.substr(1));
  double timestamp = 0.0;
  std::string rest;
  if (!(words >> timestamp) || !std::getline(words, rest)) return std::nullopt;
  if (!rest.empty() && rest.back() == '\r') rest.pop_back();
  if (rest != gap_words || !std::isfinite(timestamp)) return std::nullopt;
  return timestamp;
}

/// What is wrong with a detection as read, or nothing.
std::string problem_of(double timestamp, const Detection& d) {
  const auto finite = [](float v) { return std::isfinite(v); };
  if (!std::isfinite(timestamp)) return "the time stamp is no number";
  if (d.class_id != Detection::motion_class &&
      (d.class_id < 0 || d.class_id >= ClassTable::class_count)) {
    return fmt::format("class {} is none of 0 to {} (or {})", d.class_id,
                       ClassTable::class_count - 1, Detection::motion_class);
  }
  if (!(d.score >= 0.0F && d.score <= 1.0F)) return "the score must be from 0 to 1";
  if (!finite(d.box.x) || !finite(d.box.y) || !finite(d.box.width) || !finite(d.box.height) ||
      d.box.width <= 0.0F || d.box.height <= 0.0F) {
    return "the box must be finite, its width and height above 0";
  }
  return "";
}

}  // namespace

std::unique_ptr<Detector> open_recorded_detections(const std::filesystem::path& file,
                                                   const ClassTable& classes) {
  constexpr std::uintmax_t most_bytes = 4'000'000'000;
  std::ifstream in = open_text(file, most_bytes, "cannot read the detections", "check the path");
  std::map<std::int64_t, std::vector<Detection>> of_stamp;
  std::set<std::int64_t> gaps;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (line[0] == '#') {
      if (const auto gap = gap_of(line)) gaps.insert(microseconds(*gap));
      continue;
    }
    std::istringstream words(line);
    double timestamp = 0.0;
    Detection d;
    std::string rest;
    words >> timestamp >> d.class_id >> d.score >> d.box.x >> d.box.y >> d.box.width >>
        d.box.height;
    if (!words || words >> rest) {
      throw Error(fmt::format(
          "{}:{}: a line must hold timestamp class_id score x y width height, all numbers",
          file.string(), number));
    }
    if (const std::string problem = problem_of(timestamp, d); !problem.empty()) {
      throw Error(fmt::format("{}:{}: {}", file.string(), number, problem));
    }
    d.weight = classes.weight(d.class_id);
    of_stamp[microseconds(timestamp)].push_back(d);
  }
  if (in.bad()) throw Error(file.string() + ": cannot read the detections to their end");
  return std::make_unique<RecordedDetector>("recorded (" + file.filename().string() + ")",
                                            std::move(of_stamp), std::move(gaps));
}

std::string recorded_lines(double timestamp, const std::vector<Detection>& detections) {
  std::string out;
  for (const Detection& d : detections) {
    // Floats to the last digit, so that a repeated run is the same run.
    out += fmt::format("{:.6f} {} {} {} {} {} {}\n", timestamp, d.class_id, d.score, d.box.x,
                       d.box.y, d.box.width, d.box.height);
  }
  return out;
}

std::string recorded_gap(double timestamp) {
  return fmt::format("# {:.6f}{}\n", timestamp, gap_words);
}

std::string recorded_header() { return "# timestamp class_id score x y width height\n"; }

}  // namespace dkp_slam
