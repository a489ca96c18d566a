#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/map_report.h"
#include "apps/print_text.h"
#include "apps/process.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/json_text.h"
#include "dkp_slam/loop/map_merger.h"
#include "dkp_slam/map/map_snapshot.h"
#include "dkp_slam/map_file/landmark_cloud.h"
#include "dkp_slam/map_file/map_file.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

struct MapArguments {
  std::string file, other;  ///< map files
  fs::path out;
  bool json = false;
};

void show(const MapArguments& arguments) {
  const StoredMap stored = read_map(arguments.file);
  print_text(arguments.json ? json_text(map_json(stored)) + "\n" : printable(map_text(stored)));
}

void export_files(const MapArguments& arguments) {
  const Map map = read_map(arguments.file).map;
  std::error_code error;
  fs::create_directories(arguments.out, error);
  if (error) {
    throw Error(fmt::format("cannot make the output folder {}: {}; choose another --out",
                            arguments.out.string(), error.message()));
  }
  std::vector<std::string> names{"landmarks.ply"};
  write_file_atomically(arguments.out / names.front(), landmarks_ply(map));
  for (const MapSummary& m : summaries_of(map)) {
    names.push_back(fmt::format("keyframes_{}.txt", m.id));
    write_trajectory(arguments.out / names.back(), keyframes_of(map, m.id));
  }
  print_text(fmt::format("in {}: {}\n", arguments.out.string(), fmt::join(names, ", ")));
}

void merge(const MapArguments& arguments) {
  if (fs::exists(arguments.out)) {
    throw Error(fmt::format("{}: is there already; choose another --out", arguments.out.string()));
  }
  const StoredMap a = read_map(arguments.file), b = read_map(arguments.other);
  check_fits(b, a.map.camera(), a.map.level_scale(), a.map.levels());
  const MergedMap both = merge_maps(parts_of(a.map), parts_of(b.map));
  save_map(arguments.out, both.map);
  print_text(printable(map_text(read_map(arguments.out))));
  for (const JoinedMaps& j : both.joined) {
    print_text(
        fmt::format("maps {} and {} show the same place ({} keyframes agree): joined in map {}\n",
                    j.kept, j.moved, j.keyframes, j.kept));
  }
  if (both.joined.empty()) {
    print_text(
        fmt::format("maps of {} and {} lie side by side, each in its own world frame: no place "
                    "was found that both show\n",
                    arguments.file, arguments.other));
  }
}

}  // namespace

void add_map_command(CLI::App& program) {
  auto* command =
      program.add_subcommand("map", "Look at map files, take out or merge what they hold.");
  command->require_subcommand(1);
  const auto arguments = std::make_shared<MapArguments>();

  auto* info = command->add_subcommand("info", "What a map file holds, checked as for a run");
  info->add_option("FILE", arguments->file, "Map file")->required();
  info->add_flag("--json", arguments->json, "As JSON");
  info->callback([arguments] { show(*arguments); });

  auto* exporter = command->add_subcommand(
      "export",
      "Landmarks as a point cloud (landmarks.ply) and the keyframes of each map "
      "(keyframes_ID.txt, TUM format)");
  exporter->add_option("FILE", arguments->file, "Map file")->required();
  exporter->add_option("--out", arguments->out, "Folder for the files; made where missing")
      ->required();
  exporter->callback([arguments] { export_files(*arguments); });

  auto* merger = command->add_subcommand("merge", "The maps of two files in a new one");
  merger->add_option("A", arguments->file, "Map file")->required();
  merger->add_option("B", arguments->other, "Another, made with the same camera")->required();
  merger->add_option("--out", arguments->out, "File to make")->required();
  merger->callback([arguments] { merge(*arguments); });
}

}  // namespace dkp_slam::apps
