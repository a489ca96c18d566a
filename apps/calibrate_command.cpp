#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "apps/camera_choice.h"
#include "apps/commands.h"
#include "apps/config_options.h"
#include "apps/progress.h"
#include "dkp_slam/calibration/calibrate.h"
#include "dkp_slam/calibration/calibration_plot.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/layout/image_folder.h"
#include "dkp_slam/version.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

struct CalibrateArguments {
  std::vector<std::string> sequences;
  std::string camera, mode = "off";
  fs::path out, plot;
  std::vector<std::string> lengths;
  bool bias = false, focal = false, principal_point = false, distortion = false;
  bool depth_distortion = false;
  ConfigOptions config;
};

std::string check_figure_name(const std::string& name) {
  const std::string extension = fs::path(name).extension();
  return extension == ".svg" || extension == ".png" ? "" : "must end in .svg or .png";
}

std::vector<KnownLength> lengths_of(const CalibrateArguments& arguments) {
  std::vector<KnownLength> lengths;
  for (const std::string& text : arguments.lengths) {
    try {
      lengths.push_back(parse_known_length(text));
    } catch (const Error& error) {
      throw CLI::ValidationError("--length", error.what());
    }
  }
  return lengths;
}

std::vector<CalibrationSequence> open_sequences(const std::vector<std::string>& folders) {
  std::vector<CalibrationSequence> sequences;
  for (const std::string& folder : folders) {
    sequences.push_back({folder, [folder](const Camera& camera) {
                           return open_image_folder(folder, camera, TumOptions());
                         }});
  }
  return sequences;
}

void write_figure(const fs::path& path, const Calibration& found, const std::string& title) {
  const auto canvas = path.extension() == ".svg"
                          ? svg_canvas(calibration_plot_width, calibration_plot_height)
                          : png_canvas(calibration_plot_width, calibration_plot_height);
  draw_calibration(*canvas, found, title);
  write_file_atomically(path, canvas->encode());
}

std::string table_of(const Calibration& found) {
  std::string text = fmt::format(
      "{} frames, {} pieces, {} sightings ({:.2f} px), {} depths; {} rounds\n", found.frames,
      found.windows, found.sightings, found.noise.pixel, found.depths, found.rounds);
  for (const FoundValue& v : found.values) {
    if (v.found) {
      text += fmt::format("{:<12} {:>10.6g} +- {:<8.2g} {:<8} was {:.6g}\n", v.key, v.value,
                          v.sigma, v.unit, v.before);
    } else {
      text += fmt::format("{:<12} {:>10.6g} as it was: {}\n", v.key, v.value, v.reason);
    }
  }
  return text;
}

void calibrate_camera(const CalibrateArguments& arguments) {
  catch_interrupts();
  SlamConfig config = make_config(arguments.config);
  config.dynamics.mode = mode_named(arguments.mode);
  if (config.dynamics.mode == DynamicsMode::masks) {
    throw CLI::ValidationError("--mode", "masks is none of calibrate's: it reads no --masks");
  }
  CalibrationOptions options;
  options.bias = arguments.bias;
  options.focal = arguments.focal;
  options.principal_point = arguments.principal_point;
  options.distortion = arguments.distortion;
  options.depth_distortion = arguments.depth_distortion;
  options.lengths = lengths_of(arguments);
  options.stop = &interrupt_flag();
  const fs::path camera = choose_camera(arguments.sequences.front(), arguments.camera);
  if (arguments.camera.empty()) spdlog::info("camera: {}", camera.string());
  config.camera = load_camera(camera);
  const std::vector<CalibrationSequence> sequences = open_sequences(arguments.sequences);
  // Each is opened once, so that a wrong one is found before the first has been played.
  for (const CalibrationSequence& s : sequences) s.open(config.camera);
  check_writable(arguments.out);
  if (!arguments.plot.empty()) check_writable(arguments.plot);

  std::unique_ptr<Progress> progress;
  std::size_t last = 0;
  int playing = 0;
  const Calibration found =
      calibrate(sequences, config, options, [&](int, std::size_t frame, std::size_t frames) {
        if (!progress || frame < last) {
          progress.reset();
          progress = std::make_unique<Progress>(fmt::format("calibrate {}", ++playing), frames);
        }
        last = frame;
        progress->update(frame);
      });
  progress.reset();
  std::string names;
  for (const std::string& s : arguments.sequences) names += " " + fs::path(s).filename().string();
  if (!arguments.plot.empty()) write_figure(arguments.plot, found, "calibrate" + names);
  write_file_atomically(
      arguments.out,
      calibration_text(found, fmt::format("dkp-slam {} calibrate{}", DKP_SLAM_VERSION, names)));
  std::fputs(table_of(found).c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace

void add_calibrate_command(CLI::App& program) {
  const auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command = program.add_subcommand(
      "calibrate",
      "Finds what a camera file says of times and depth, from the images of sequences in which the "
      "camera is turned to and fro: readout and delay of depth, on request bias and lens, and "
      "with a known length the depth scale.");
  command->add_option("SEQUENCE", arguments->sequences, "Folders of images, one camera")
      ->required();
  command->add_option("--out", arguments->out, "Camera file to write")->required();
  command->add_option("--camera", arguments->camera,
                      fmt::format("Camera file to begin with, or {}; else ", camera_names) +
                          "SEQUENCE/camera.yaml, else by the folder's layout or name");
  command->add_option("--plot", arguments->plot, "Draw what shows it: .svg or .png")
      ->check(check_figure_name);
  command->add_flag("--bias", arguments->bias, "Find the bias of depth, too");
  command->add_flag("--focal", arguments->focal, "Find the focal lengths, too");
  command->add_flag("--principal-point", arguments->principal_point,
                    "Find the principal point, too");
  command->add_flag("--distortion", arguments->distortion, "Find the lens distortion, too");
  command->add_flag("--depth-distortion", arguments->depth_distortion,
                    "Find how depth is off across the image, too");
  command->add_option(
      "--length", arguments->lengths,
      "A known length, for the depth scale: TIMESTAMP,u1,v1,u2,v2,METRES, two pixels on flat "
      "surfaces in a colour image of the first sequence and their distance; may be repeated");
  command
      ->add_option("--mode", arguments->mode,
                   "What is removed, as in run; a room without people needs nothing removed")
      ->check(CLI::IsMember({"off", "paper", "d", "dk", "dkp", "dkp+"}))
      ->capture_default_str();
  add_config_options(*command, arguments->config);
  command->callback([arguments] { calibrate_camera(*arguments); });
}

}  // namespace dkp_slam::apps
