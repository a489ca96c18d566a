#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/export_dense.h"
#include "apps/map_report.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/export/path_formats.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/map_file/landmark_cloud.h"
#include "dkp_slam/map_file/map_file.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

struct ExportArguments {
  fs::path what;  ///< a trajectory, the folder of a run, or a map file
  std::string format;
  fs::path out;        ///< of the path; empty for none
  fs::path landmarks;  ///< of a map file; empty for none
  bool keyframes = false;
  std::optional<int> map;  ///< of a map file with several
  DenseExport dense;
};

/// The folder of a run, a map file, or else a trajectory as text.
enum class Kind { run, map, trajectory };

Kind kind_of(const fs::path& what) {
  std::error_code error;
  if (fs::is_directory(what, error)) return Kind::run;
  std::ifstream file(what, std::ios::binary);
  std::string first(16, '\0');
  file.read(first.data(), static_cast<std::streamsize>(first.size()));
  return first.starts_with("SQLite format 3") ? Kind::map : Kind::trajectory;
}

/// The file of a run that holds its path.
fs::path path_of_run(const ExportArguments& arguments) {
  const char* name = arguments.keyframes ? "keyframes.txt" : "trajectory.txt";
  if (fs::exists(arguments.what / name)) return arguments.what / name;
  throw Error(fmt::format("{}: holds no {}; give the folder that `dkp-slam run --out` wrote",
                          arguments.what.string(), name));
}

/// Id of the map that is meant: the one with the most keyframes unless the user says.
int map_id(const ExportArguments& arguments, const Map& map) {
  const std::vector<MapSummary> maps = summaries_of(map);
  if (maps.empty()) {
    throw Error(fmt::format("{}: the map holds no keyframe; there is nothing to export",
                            arguments.what.string()));
  }
  const auto found = arguments.map
                         ? std::find_if(maps.begin(), maps.end(),
                                        [&](const MapSummary& m) { return m.id == *arguments.map; })
                         : std::max_element(maps.begin(), maps.end(),
                                            [](const MapSummary& a, const MapSummary& b) {
                                              return a.keyframes < b.keyframes;
                                            });
  if (found != maps.end()) return found->id;
  throw Error(fmt::format("{}: has no map {} (--map-id); `dkp-slam map info` lists them",
                          arguments.what.string(), *arguments.map));
}

PathFormat format_of(const ExportArguments& arguments) {
  const auto& formats = path_formats();
  const std::string ending = arguments.out.extension();
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const PathFormatInfo& f) {
    if (!arguments.format.empty()) return arguments.format == f.name;
    return !ending.empty() && std::string_view(f.ending).ends_with(ending);
  });
  if (found != formats.end()) return found->format;
  throw CLI::ValidationError(
      "--out", fmt::format("{} does not tell the format; give --format", arguments.out.string()));
}

void check_usage(const ExportArguments& arguments) {
  const bool path = !arguments.out.empty(), landmarks = !arguments.landmarks.empty();
  if (!path && !landmarks && !arguments.dense.any()) {
    throw CLI::ValidationError(
        "export",
        "nothing to write: give --out, --landmarks, --dense, --mesh, --grid or --octomap");
  }
  if (path) format_of(arguments);
  if (!path && !arguments.format.empty()) {
    throw CLI::ValidationError("--format", "is the format of --out, which is missing");
  }
}

void export_map(const ExportArguments& arguments) {
  if (arguments.dense.any()) {
    throw CLI::ValidationError(arguments.what.string(),
                               "is a map file, which holds no images: the dense map is made of a "
                               "run's folder or a trajectory, and --sequence");
  }
  const Map map = read_map(arguments.what).map;
  const int id = map_id(arguments, map);
  if (!arguments.out.empty()) {
    write_path(format_of(arguments), arguments.out, keyframes_of(map, id));
  }
  if (!arguments.landmarks.empty()) {
    if (map.live_landmarks() == 0) {
      throw Error(fmt::format("{}: the map holds no landmark; there is nothing to export",
                              arguments.what.string()));
    }
    write_file_atomically(arguments.landmarks, landmarks_ply(map));
  }
}

void export_run(const ExportArguments& arguments, Kind kind) {
  if (!arguments.landmarks.empty() || arguments.map) {
    throw CLI::ValidationError(
        arguments.landmarks.empty() ? "--map-id" : "--landmarks",
        arguments.what.string() + " is no map file; `dkp-slam run --map FILE` keeps one");
  }
  const fs::path file = kind == Kind::run ? path_of_run(arguments) : arguments.what;
  const Trajectory path = read_trajectory(file);
  if (!arguments.out.empty()) write_path(format_of(arguments), arguments.out, path);
  if (!arguments.dense.any()) return;
  export_dense(arguments.dense, kind == Kind::run ? arguments.what : fs::path(), path);
}

void export_files(const ExportArguments& arguments) {
  check_usage(arguments);
  for (const fs::path& file : {arguments.out, arguments.landmarks}) {
    if (!file.empty()) check_writable(file);
  }
  arguments.dense.check();
  const Kind kind = kind_of(arguments.what);
  kind == Kind::map ? export_map(arguments) : export_run(arguments, kind);
}

std::vector<std::string> names_of_formats() {
  std::vector<std::string> names;
  for (const PathFormatInfo& f : path_formats()) names.emplace_back(f.name);
  return names;
}

}  // namespace

void add_export_command(CLI::App& program) {
  const auto arguments = std::make_shared<ExportArguments>();
  auto* command = program.add_subcommand(
      "export",
      "A camera's path in other programs' formats, a map file's landmarks, and, with the images, "
      "the static world as point cloud, mesh, grid and octree (docs/export.md).");
  command
      ->add_option("WHAT", arguments->what,
                   "The folder of a run, a trajectory (TUM format), or a map file")
      ->required();
  command->add_option("--out", arguments->out, "File for the path");
  command
      ->add_option("--format", arguments->format,
                   "Of the path: tum, kitti, euroc, ply or gltf; default: by the file's ending "
                   "(.txt tum, .csv euroc, .ply, .gltf)")
      ->check(CLI::IsMember(names_of_formats()));
  command->add_flag("--keyframes", arguments->keyframes,
                    "The path of a run's keyframes alone, also for the dense map");
  command->add_option("--landmarks", arguments->landmarks,
                      "File for a map file's landmarks, as a point cloud (PLY)");
  command->add_option("--map-id", arguments->map,
                      "Which map of a map file; default: the one with the most keyframes");
  add_dense_options(*command, arguments->dense);
  command->callback([arguments] { export_files(*arguments); });
}

}  // namespace dkp_slam::apps
