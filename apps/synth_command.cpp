#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/progress.h"
#include "apps/whole_number.h"
#include "dkp_slam/error.h"
#include "dkp_slam/geometry/sensor_scale.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/synth/folder/synthetic_folder.h"
#include "dkp_slam/synth/source.h"

namespace dkp_slam::apps {
namespace {

struct SynthArguments {
  std::string scenario;
  std::string out;
  std::uint64_t seed = 1;
  std::optional<std::size_t> frames;
  int width = 640;
  int height = 480;
  double rate = 30.0;
  std::string trajectory;
  std::string noise = "kinect";
  bool rolling_shutter = false;
  std::optional<double> readout, depth_readout;
  double depth_scale = 5000.0;
  DepthCorrection depth;
  bool force = false;
};

SyntheticOptions options_of(const SynthArguments& arguments) {
  SyntheticOptions options = synthetic_scenario(arguments.scenario);
  options.seed = arguments.seed;
  options.kinect_noise = arguments.noise == "kinect";
  options.trajectory = arguments.trajectory;
  options.camera = resized(options.camera, arguments.width, arguments.height);
  const double usual_rate = options.camera.frame_rate;
  options.camera.frame_rate = arguments.rate;
  // As many seconds at any rate, and as long as the recorded path lasts where there is one.
  options.frames = static_cast<std::size_t>(
      std::lround(static_cast<double>(options.frames) * arguments.rate / usual_rate));
  if (!arguments.trajectory.empty()) options.frames = 0;
  if (arguments.frames) options.frames = *arguments.frames;
  // The Kinect's and the Xtion's, as in config/tum_fr3.yaml.
  if (arguments.rolling_shutter) options.camera.readout = 0.020;
  if (arguments.readout) options.camera.readout = *arguments.readout;
  options.camera.depth_readout = arguments.depth_readout;
  options.camera.depth_scale = arguments.depth_scale;
  options.camera.depth_correction = arguments.depth;
  return options;
}

void synthesize(const SynthArguments& arguments) {
  catch_interrupts();
  // What can be wrong is found before the folder is touched, and the cheap part of it first: to
  // light the rooms takes seconds.
  const SyntheticOptions options = options_of(arguments);
  check_synthetic_folder(arguments.out, arguments.force);
  SyntheticSource source(options);
  const std::size_t frames = *source.size();
  Progress progress("synth " + arguments.scenario, frames);
  const std::size_t done =
      write_synthetic_folder(arguments.out, options, source, [&](std::size_t written) {
        if (written > 0) progress.update(written);
        return !interrupted();
      });
  if (done < frames) {
    throw Error(fmt::format("interrupted after {} of {} frames; {} holds these", done, frames,
                            arguments.out));
  }
}

std::vector<std::string> names_of_scenarios() {
  std::vector<std::string> names;
  for (const ScenarioName& scenario : scenario_names()) names.push_back(scenario.name);
  return names;
}

/// For the help: one scenario a line.
std::string descriptions() {
  std::string text = "Scenarios:\n";
  for (const ScenarioName& s : scenario_names()) {
    text += fmt::format("  {:<20} {}\n", s.name, s.description);
  }
  return text;
}

/// What may be wrong with depth; camera.yaml says it.
void add_depth_options(CLI::App& command, SynthArguments& arguments) {
  command.add_option("--depth-scale", arguments.depth_scale, "Depth images' units per metre")
      ->check(CLI::Range(1000.0, 20000.0))
      ->capture_default_str();
  command
      .add_option("--depth-delay", arguments.depth.delay,
                  "Seconds by which depth is taken after its colour image; the stamps are equal")
      ->check(CLI::Range(-0.1, 0.1))
      ->capture_default_str();
  command
      .add_option("--depth-bias", arguments.depth.bias,
                  "Metres that depth images lack: to be added to each depth")
      ->check(CLI::Range(-0.2, 0.2))
      ->capture_default_str();
  command
      .add_option_function<std::vector<double>>(
          "--depth-distortion",
          [&arguments](const std::vector<double>& nine) {
            arguments.depth.distortion.coefficients =
                Eigen::Map<const DepthDistortion::Terms>(nine.data());
          },
          "By which depth images are off, as in camera.yaml: nine numbers, 1/metre")
      ->expected(DepthDistortion::size)
      ->delimiter(',')
      ->check(CLI::Range(-0.1, 0.1));
}

}  // namespace

void add_synth_command(CLI::App& program) {
  const auto arguments = std::make_shared<SynthArguments>();
  CLI::App* command = program.add_subcommand(
      "synth",
      "Generates a sequence of furnished rooms with people in them, as a TUM RGB-D folder with the "
      "true camera path (groundtruth.txt), true masks of all that moves (mask/), of each by itself "
      "(instances/), and true boxes (detections.txt).");
  command->footer(descriptions());
  command->add_option("SCENARIO", arguments->scenario, "What happens: one of those listed below")
      ->required()
      ->check(CLI::IsMember(names_of_scenarios()));
  command->add_option("--out", arguments->out, "Folder to write")->required();
  command
      ->add_option("--seed", arguments->seed, "Room, people's looks and pace, camera path, noise")
      ->check(check_whole_number)
      ->capture_default_str();
  command
      ->add_option("--frames", arguments->frames,
                   "Frames [20 seconds; as many as moved_furniture and flat_loop take; of a "
                   "trajectory all]")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000000}));
  command->add_option("--width", arguments->width, "Of the images, pixels; the view stays as wide")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  command
      ->add_option("--height", arguments->height,
                   "Of the images, pixels; for another shape the view is cut off above and below, "
                   "or sees more")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  command->add_option("--rate", arguments->rate, "Frames a second; all moves as fast as ever")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str();
  command->add_option("--trajectory", arguments->trajectory,
                      "Camera path (TUM format, z up) instead of the scenario's own; it is put "
                      "into the office as a whole");
  command->add_option("--noise", arguments->noise, "Sensor noise: kinect or none")
      ->check(CLI::IsMember({"kinect", "none"}))
      ->capture_default_str();
  auto* rolling =
      command->add_flag("--rolling-shutter", arguments->rolling_shutter,
                        "Read the image row by row in 20 ms, as the Kinect's colour camera does");
  command->add_option("--readout", arguments->readout, "The same in so many seconds")
      ->check(CLI::Range(0.0, 1.0))
      ->excludes(rolling);
  command
      ->add_option("--depth-readout", arguments->depth_readout,
                   "The same of the depth image, if it differs; 0: all of it at one moment")
      ->check(CLI::Range(0.0, 1.0));
  add_depth_options(*command, *arguments);
  command->add_flag("--force", arguments->force,
                    "Write into a folder not made by this command; files of the names that this "
                    "command writes are replaced");
  command->callback([arguments] { synthesize(*arguments); });
}

}  // namespace dkp_slam::apps
