#include "dkp_slam/export/trajectory.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 8> field_names = {"timestamp", "tx", "ty", "tz",
                                                         "qx",        "qy", "qz", "qw"};
constexpr std::string_view separators = " \t,\r\v\f";
// Far below any quaternion a program would write and far above what rounds to zero.
constexpr double min_quaternion_norm = 1e-6;
constexpr double farthest = 1e9;  // metres; squares of it are still summed exactly enough

/// Where an error is, for its message.
struct Place {
  const fs::path& path;
  std::size_t line;
};

[[noreturn]] void fail(const Place& place, const std::string& reason) {
  throw Error(fmt::format("{}:{}: {}", place.path.string(), place.line, reason));
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  std::size_t begin = line.find_first_not_of(separators);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(separators, end);
  }
  return fields;
}

/// A piece of the file that is fit for a one-line message.
std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 30;
  std::string printable(text.substr(0, longest));
  std::replace_if(
      printable.begin(), printable.end(), [](unsigned char c) { return std::isprint(c) == 0; },
      '?');
  return "'" + printable + (text.size() > longest ? "...'" : "'");
}

double parse_field(std::string_view text, std::size_t index, const Place& place) {
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    fail(place, fmt::format("{} is {}, not a number; write 'timestamp tx ty tz qx qy qz qw'",
                            field_names[index], quoted(text)));
  }
  if (!std::isfinite(value)) {
    fail(place, fmt::format("{} is {}; remove the line: a pose that is not known has no line",
                            field_names[index], quoted(text)));
  }
  return value;
}

StampedPose parse_pose(std::string_view line, const Place& place) {
  const std::vector<std::string_view> fields = split(line);
  if (fields.size() != field_names.size()) {
    fail(place, fmt::format("{} {}, expected the 8 of 'timestamp tx ty tz qx qy qz qw'",
                            fields.size(), fields.size() == 1 ? "field" : "fields"));
  }
  std::array<double, 8> v{};
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = parse_field(fields[i], i, place);
  const Eigen::Quaterniond rotation(v[7], v[4], v[5], v[6]);
  if (!(rotation.norm() > min_quaternion_norm)) {
    fail(place, "the quaternion is zero; write '0 0 0 1' for no rotation, or remove the line");
  }
  // Squares of larger ones are no numbers any more.
  if (!std::isfinite(rotation.squaredNorm())) {
    fail(place, "the quaternion is far from length 1; write '0 0 0 1' for no rotation");
  }
  const Eigen::Vector3d position(v[1], v[2], v[3]);
  const double distance = position.stableNorm();  // of which nothing overflows
  if (!(distance <= farthest)) {
    fail(place, fmt::format("the position is {:.3g} m away; the unit is the metre, and no path is "
                            "longer than {:.0e} m",
                            distance, farthest));
  }
  return {v[0], Se3(rotation.normalized(), position)};
}

/// Puts poses into the order of their stamps, the last of each stamp only; says so when it has to.
Trajectory in_order(Trajectory poses, const fs::path& path) {
  const auto earlier = [](const StampedPose& a, const StampedPose& b) {
    return a.timestamp < b.timestamp;
  };
  if (!std::is_sorted(poses.begin(), poses.end(), earlier)) {
    spdlog::warn("{}: time stamps are out of order; sorted", path.string());
    std::stable_sort(poses.begin(), poses.end(), earlier);
  }
  Trajectory unique;
  unique.reserve(poses.size());
  for (const StampedPose& pose : poses) {
    if (!unique.empty() && unique.back().timestamp == pose.timestamp) unique.pop_back();
    unique.push_back(pose);
  }
  if (unique.size() < poses.size()) {
    spdlog::warn("{}: {} time stamps come again; the last line of each counts", path.string(),
                 poses.size() - unique.size());
  }
  return unique;
}

}  // namespace

Trajectory read_trajectory(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    throw Error(
        fmt::format("{}: no such file; give a trajectory file in TUM format", path.string()));
  }
  if (fs::is_directory(path, error)) {
    throw Error(fmt::format("{}: is a folder; give the trajectory file in it", path.string()));
  }
  if (fs::is_character_file(path, error) || fs::is_block_file(path, error)) {
    throw Error(fmt::format("{}: is a device; give a trajectory file", path.string()));
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(fmt::format("{}: cannot be opened; check its rights", path.string()));
  Trajectory poses;
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    const std::size_t first = line.find_first_not_of(separators);
    if (first == std::string::npos || line[first] == '#') continue;
    poses.push_back(parse_pose(line, {path, number}));
  }
  if (stream.bad()) throw Error(fmt::format("{}: reading failed; check the disk", path.string()));
  if (poses.empty()) {
    throw Error(fmt::format("{}: no pose in it; expected lines of 'timestamp tx ty tz qx qy qz qw'",
                            path.string()));
  }
  return in_order(std::move(poses), path);
}

std::string trajectory_line(const StampedPose& pose) {
  const Eigen::Vector3d& t = pose.world_from_camera.translation;
  Eigen::Quaterniond q = pose.world_from_camera.rotation.normalized();
  if (!std::isfinite(pose.timestamp) || !t.allFinite() || !q.coeffs().allFinite()) {
    throw Error(fmt::format("the pose at {:.6f} s is not finite; leave it out", pose.timestamp));
  }
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  return fmt::format("{:.6f} {:.7f} {:.7f} {:.7f} {:.9f} {:.9f} {:.9f} {:.9f}\n", pose.timestamp,
                     t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

void write_trajectory(const fs::path& path, std::span<const StampedPose> poses) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  try {
    for (const StampedPose& pose : poses) text += trajectory_line(pose);
  } catch (const Error& error) {
    throw Error(fmt::format("cannot write {}: {}", path.string(), error.what()));
  }
  write_file_atomically(path, text);
}

}  // namespace dkp_slam
