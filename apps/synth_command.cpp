#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/commands.h"
#include "apps/progress.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/synthetic/source.h"
#include "dkp_slam/version.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

// Written first and by nothing else: a folder that holds it may be replaced.
const std::string marker = "synth.json";
const std::vector<std::string> image_folders = {"rgb", "depth", "mask"};

struct SynthArguments {
  std::string scenario;
  std::string out;
  std::uint64_t seed = 1;
  std::size_t frames = 300;
  std::string noise = "kinect";
  bool force = false;
};

/// Makes the output folder with nothing of ours in it, or throws before anything is changed.
void prepare_folder(const fs::path& out, bool force) {
  try {
    if (fs::exists(out) && !fs::is_directory(out)) {
      throw Error(out.string() + ": is no folder; give another --out");
    }
    if (fs::exists(out) && !fs::is_empty(out) && !fs::exists(out / marker) && !force) {
      throw Error(
          fmt::format("{}: is not empty and was not made by this command; give another "
                      "--out, or --force to write into it",
                      out.string()));
    }
    fs::create_directories(out);
    check_writable(out / marker);
    for (const std::string& folder : image_folders) {
      fs::remove_all(out / folder);
      fs::create_directory(out / folder);
    }
    for (const char* list : {"rgb.txt", "depth.txt", "associations.txt", "groundtruth.txt"}) {
      fs::remove(out / list);
    }
  } catch (const fs::filesystem_error& error) {
    throw Error(
        fmt::format("{}: cannot prepare the folder: {}", out.string(), error.code().message()));
  }
}

void write_image(const fs::path& path, const cv::Mat& image) {
  bool written = false;
  try {
    written = cv::imwrite(path.string(), image);
  } catch (const cv::Exception&) {
  }
  if (!written) throw Error(path.string() + ": cannot write; is the disk full?");
}

/// What the lists of a TUM folder say; grows frame by frame.
class SequenceWriter {
 public:
  explicit SequenceWriter(fs::path out) : out_(std::move(out)) {}

  void add(const RgbdFrame& frame, const SyntheticTruth& truth, double units_per_metre) {
    const std::string stamp = fmt::format("{:.6f}", frame.timestamp);
    const std::string colour = "rgb/" + stamp + ".png", depth = "depth/" + stamp + ".png";
    cv::Mat units;
    frame.depth.convertTo(units, CV_16U, units_per_metre);
    write_image(out_ / colour, frame.colour);
    write_image(out_ / depth, units);
    write_image(out_ / "mask" / (stamp + ".png"), truth.mask);
    rgb_ += fmt::format("{} {}\n", stamp, colour);
    depth_ += fmt::format("{} {}\n", stamp, depth);
    associations_ += fmt::format("{} {} {} {}\n", stamp, colour, stamp, depth);
    poses_.push_back({frame.timestamp, truth.world_from_camera});
  }

  void write_lists() const {
    write_file_atomically(out_ / "rgb.txt", "# timestamp filename\n" + rgb_);
    write_file_atomically(out_ / "depth.txt", "# timestamp filename\n" + depth_);
    write_file_atomically(out_ / "associations.txt", associations_);
    write_trajectory(out_ / "groundtruth.txt", poses_);
  }

 private:
  fs::path out_;
  std::string rgb_, depth_, associations_;
  Trajectory poses_;
};

void synthesize(const SynthArguments& arguments) {
  SyntheticOptions options = synthetic_scenario(arguments.scenario);
  options.seed = arguments.seed;
  options.frames = arguments.frames;
  options.kinect_noise = arguments.noise == "kinect";
  const fs::path out = arguments.out;
  prepare_folder(out, arguments.force);
  const nlohmann::ordered_json description = {
      {"program", std::string("dkp-slam ") + DKP_SLAM_VERSION},
      {"scenario", arguments.scenario},
      {"seed", arguments.seed},
      {"frames", arguments.frames},
      {"noise", arguments.noise}};
  write_file_atomically(out / marker, description.dump(2) + "\n");
  save_camera(options.camera, out / "camera.yaml");

  catch_interrupts();
  SyntheticSource source(options);
  SequenceWriter writer(out);
  std::size_t done = 0;
  {
    Progress progress("synth " + arguments.scenario, options.frames);
    while (!interrupted()) {
      const auto frame = source.read();
      if (!frame) break;
      writer.add(*frame, source.truth(), options.camera.depth_scale);
      progress.update(++done);
    }
  }
  writer.write_lists();
  if (done < options.frames) {
    throw Error(fmt::format("interrupted after {} of {} frames; {} holds these", done,
                            options.frames, out.string()));
  }
}

}  // namespace

void add_synth_command(CLI::App& program) {
  const auto arguments = std::make_shared<SynthArguments>();
  CLI::App* command = program.add_subcommand(
      "synth",
      "Generates a sequence of a furnished room with walking people, as a TUM RGB-D folder "
      "with true camera path (groundtruth.txt) and true masks (mask/).");
  command->add_option("SCENARIO", arguments->scenario, "Who walks, and how the camera moves")
      ->required()
      ->check(CLI::IsMember({"walking_xyz", "walking_halfsphere", "walking_static", "static_xyz"}));
  command->add_option("--out", arguments->out, "Folder to write")->required();
  command->add_option("--seed", arguments->seed, "Room, clothes, camera path and noise")
      ->capture_default_str();
  command->add_option("--frames", arguments->frames, "Frames, 30 a second")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000000}))
      ->capture_default_str();
  command->add_option("--noise", arguments->noise, "Sensor noise: kinect or none")
      ->check(CLI::IsMember({"kinect", "none"}))
      ->capture_default_str();
  command->add_flag(
      "--force", arguments->force,
      "Write into a folder not made by this command; its rgb, depth and mask are replaced");
  command->callback([arguments] { synthesize(*arguments); });
}

}  // namespace dkp_slam::apps
