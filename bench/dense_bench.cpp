// Measures dense maps against the truth: which share of their points lies where only people were,
// and how far they lie from the true room. docs/export.md has the figures; bench/dense.sh makes
// them.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>

#include "bench/benches.h"
#include "bench/dense/room_distance.h"
#include "dkp_slam/dense/depth_view.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/json_integer.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "dkp_slam/synth/scenario.h"

namespace dkp_slam::bench {
namespace dense {
namespace fs = std::filesystem;
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

struct Arguments {
  fs::path sequence, camera, trajectory;
  fs::path background;  ///< of a composite: the same without the people; empty: it is unmasked
  std::vector<fs::path> clouds;
  int every = 2;
  double range = 5.0;
};

constexpr double cell_size = 0.02;  // metres
constexpr int reach = 2;            // cells: what a Kinect's noise and the paths' error make of one
constexpr double off_room = 0.04;   // metres from the room that are surely not the room
constexpr int enough_views = 2;

/// Places that something was seen at.
class Places {
 public:
  void add(const Vector3d& p, int view) {
    const Vector3i cell = cell_of(p);
    seen_.add(seen_.block_of(cell));
    Seen& at = (*seen_.find(seen_.block_of(cell)))[seen_.index_in_block(cell)];
    if (at.last == view) return;
    at.last = view;
    ++at.views;
  }
  /// Whether enough views saw something within the reach.
  bool near(const Vector3d& p, int views) const {
    const Vector3i centre = cell_of(p);
    for (int z = -reach; z <= reach; ++z) {
      for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
          const Seen* at = seen_.cell(centre + Vector3i(x, y, z));
          if (at && at->views >= views) return true;
        }
      }
    }
    return false;
  }

 private:
  struct Seen {
    int views = 0, last = -1;
  };
  static Vector3i cell_of(const Vector3d& p) { return (p / cell_size).array().floor().cast<int>(); }
  BlockGrid<Seen> seen_{1U << 30U};
};

/// What is true of a sequence: where people, other moving things (chairs, boxes) and the rest were,
/// in the true frame.
struct Truth {
  Places people, things, rest;
  std::unique_ptr<RoomDistance> room;  ///< of a generated world; null of a real one

  bool is_static(const Vector3d& p) const {
    return room ? (*room)(p) < off_room : rest.near(p, enough_views);
  }
};

void add_points(const Camera& camera, const cv::Mat& depth, const cv::Mat& where, const Se3& pose,
                int view, Places& places) {
  for (int v = 0; v < depth.rows; v += 2) {
    for (int u = 0; u < depth.cols; u += 2) {
      const float z = depth.at<float>(v, u);
      if (z <= 0.0F || where.at<std::uint8_t>(v, u) == 0) continue;
      places.add(pose * camera.unproject({double(u), double(v)}, z), view);
    }
  }
}

/// The true pose nearest to a time; false where none is within 10 ms.
bool pose_at(const Trajectory& path, double time, Se3& pose) {
  const auto next = std::lower_bound(path.begin(), path.end(), time,
                                     [](const auto& p, double t) { return p.timestamp < t; });
  double best = 0.01;
  for (const auto at : {next, next == path.begin() ? next : std::prev(next)}) {
    if (at == path.end() || std::abs(at->timestamp - time) >= best) continue;
    best = std::abs(at->timestamp - time);
    pose = at->world_from_camera;
  }
  return best < 0.01;
}

void add_rest(const DepthViewer& viewer, const RgbdFrame& frame, const Se3& pose, Places& rest) {
  const StaticView view = viewer.view(frame, pose);
  const cv::Mat all(view.surface.size(), CV_8UC1, cv::Scalar(1));
  add_points(viewer.camera(), view.surface, all, pose, frame.index, rest);
}

/// Which values of a mask are people: of a generated world's instances those of that class, else
/// all but 0.
cv::Mat people_table(const Scenario* scenario) {
  cv::Mat table(1, 256, CV_8UC1, cv::Scalar(scenario ? 0 : 255));
  table.at<std::uint8_t>(0) = 0;
  for (std::size_t i = 0; scenario && i < scenario->actors.size(); ++i) {
    if (scenario->actors[i]->class_name() == "person")
      table.at<std::uint8_t>(static_cast<int>(i) + 1) = 255;
  }
  return table;
}

Truth truth_of(const Arguments& arguments, const Trajectory& path) {
  Truth truth;
  std::optional<Scenario> scenario;
  if (std::ifstream synth(arguments.sequence / "synth.json"); synth) {
    const auto json = nlohmann::json::parse(synth);
    scenario = make_scenario(json.at("scenario").get<std::string>(),
                             integer_at<std::uint64_t>(json, "seed"));
    truth.room = std::make_unique<RoomDistance>(scenario->place.meshes);
  }
  const cv::Mat table = people_table(scenario ? &*scenario : nullptr);
  const Camera camera = load_camera(arguments.camera);
  DepthViewOptions options;
  options.max_range = arguments.range;
  const DepthViewer viewer(camera, options);
  TumOptions images;
  images.masks = arguments.sequence / (scenario ? "instances" : "mask");
  const auto source = open_tum_folder(arguments.sequence, camera, images);
  while (auto frame = source->read()) {
    if (frame->index % arguments.every != 0 || frame->mask.empty()) continue;
    Se3 pose;
    if (!pose_at(path, frame->timestamp, pose)) continue;
    if (arguments.background.empty()) add_rest(viewer, *frame, pose, truth.rest);
    cv::Mat on_people;
    cv::LUT(frame->mask, table, on_people);
    add_points(camera, frame->depth, on_people, pose, frame->index, truth.people);
    add_points(camera, frame->depth, frame->mask - on_people, pose, frame->index, truth.things);
  }
  if (!arguments.background.empty()) {
    images.masks.clear();
    const auto background = open_tum_folder(arguments.background, camera, images);
    while (auto frame = background->read()) {
      Se3 pose;
      if (pose_at(path, frame->timestamp, pose)) add_rest(viewer, *frame, pose, truth.rest);
    }
  }
  return truth;
}

/// Estimate's world frame to the truth's, by the mean of what each pose says. The alignment of ATE
/// goes by positions alone, which tell nothing of the turn where the camera is held still.
Se3 alignment(const Trajectory& truth, const Trajectory& estimate) {
  Eigen::Matrix4d turns = Eigen::Matrix4d::Zero();
  Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();
  double count = 0.0;
  for (const StampedPose& pose : estimate) {
    Se3 true_pose;
    if (!pose_at(truth, pose.timestamp, true_pose)) continue;
    const Eigen::Vector4d q =
        (true_pose.rotation * pose.world_from_camera.rotation.conjugate()).normalized().coeffs();
    turns += q * q.transpose();
    from += pose.world_from_camera.translation;
    to += true_pose.translation;
    count += 1.0;
  }
  if (count == 0.0) throw Error("no pose of the run has a true one within 10 ms");
  // Markley et al., "Averaging Quaternions", Journal of Guidance, Control, and Dynamics 2007.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> axes(turns);
  const Eigen::Vector4d mean = axes.eigenvectors().col(3);
  const Eigen::Quaterniond rotation(mean);
  return {rotation, (to - rotation * from) / count};
}

/// Points of a binary PLY file as `dkp-slam export` writes it.
std::vector<Vector3d> read_points(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::size_t count = 0;
  while (std::getline(in, line) && line != "end_header") {
    std::istringstream words(line);
    std::string element, vertex;
    if (words >> element >> vertex && element == "element" && vertex == "vertex") words >> count;
  }
  constexpr std::size_t record = 27;
  std::string bytes(record * count, '\0');
  if (count == 0 || !in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    throw Error(file.string() + ": no point cloud of `dkp-slam export`");
  }
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3f p;
    std::memcpy(p.data(), bytes.data() + record * i, 3 * sizeof(float));
    points.emplace_back(p.cast<double>());
  }
  return points;
}

void measure(const Arguments& arguments, const Truth& truth, const Se3& truth_from_estimate) {
  for (const fs::path& file : arguments.clouds) {
    std::size_t all = 0, of_people = 0, of_things = 0;
    std::vector<double> distances;
    for (const Vector3d& estimated : read_points(file)) {
      const Vector3d p = truth_from_estimate * estimated;
      ++all;
      const bool moved = !truth.is_static(p);
      // A chair that is used at any time is no part of the room, but it stands there.
      const bool thing = moved && truth.things.near(p, 1);
      of_things += thing;
      of_people += moved && !thing && truth.people.near(p, 1);
      if (truth.room && !thing) distances.push_back((*truth.room)(p));
    }
    fmt::print("{}: {} points, where only people were {:.3f} %, only chairs and the like {:.3f} %",
               file.string(), all, 100.0 * double(of_people) / double(all),
               100.0 * double(of_things) / double(all));
    if (!distances.empty()) {
      double sum = 0.0;
      for (const double d : distances) sum += d;
      std::sort(distances.begin(), distances.end());
      fmt::print("; from the true room mean {:.2f} cm, median {:.2f} cm, 95 % within {:.2f} cm",
                 100.0 * sum / double(distances.size()), 100.0 * distances[distances.size() / 2],
                 100.0 * distances[distances.size() * 95 / 100]);
    }
    fmt::print("\n");
  }
}

void run(Arguments& arguments) {
  if (arguments.camera.empty()) arguments.camera = arguments.sequence / "camera.yaml";
  const Trajectory path = read_trajectory(arguments.sequence / "groundtruth.txt");
  const Se3 aligned = alignment(path, read_trajectory(arguments.trajectory));
  measure(arguments, truth_of(arguments, path), aligned);
}

}  // namespace
}  // namespace dense

void add_dense(CLI::App& program) {
  CLI::App* command = program.add_subcommand("dense", "Dense maps against the truth");
  const auto arguments = std::make_shared<dense::Arguments>();
  command->add_option("SEQUENCE", arguments->sequence, "With mask/ and groundtruth.txt")
      ->required();
  command->add_option("TRAJECTORY", arguments->trajectory, "Of the run")->required();
  command->add_option("CLOUD", arguments->clouds, "PLY files that were made with it")->required();
  command->add_option("--camera", arguments->camera, "Default: SEQUENCE/camera.yaml");
  command->add_option("--background", arguments->background,
                      "Of a composite: the folder of the same without the people");
  command->add_option("--every", arguments->every, "Frames looked at for the truth")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--range", arguments->range, "As of the export, metres")
      ->capture_default_str();
  command->callback([arguments] { dense::run(*arguments); });
}

}  // namespace dkp_slam::bench
