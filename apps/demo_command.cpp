#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/demo/demo.h"
#include "apps/progress.h"
#include "apps/whole_number.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

void demo(DemoOptions options) {
  catch_interrupts();
  // A model that is named and missing is found out before a sequence is made for it.
  if (const auto model = find_model(options.model)) options.model = fs::absolute(*model);
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) {
    throw Error(fmt::format("cannot make the output folder {}: {}; choose another --out",
                            options.out.string(), error.message()));
  }
  const fs::path page = options.out / "report.html", picture = options.out / "demo.png";
  check_writable(page);
  check_writable(picture);
  const DemoResult result = make_demo(options);
  write_file_atomically(picture, demo_picture(result));
  write_file_atomically(page, demo_page(result));
  fmt::print("detector: {}\n{}\nreport: {}\npicture: {}\n", detector_text(result),
             demo_finding(result), page.string(), picture.string());
  std::fflush(stdout);
}

}  // namespace

void add_demo_command(CLI::App& program) {
  const auto options = std::make_shared<DemoOptions>();
  CLI::App* command = program.add_subcommand(
      "demo",
      "Shows what the program does: generates a room with people walking about, finds the camera's "
      "path with and without them, and writes OUT/report.html and OUT/demo.png. Needs no model, "
      "and uses YOLOX where one is found.");
  command->add_option("--out", options->out, "Folder for the results; made where missing")
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of the generated room and of everything random")
      ->check(check_whole_number)
      ->capture_default_str();
  command->add_option("--frames", options->frames, "Frames, 30 a second")
      ->check(CLI::Range(std::size_t{10}, std::size_t{100000}))
      ->capture_default_str();
  command->add_option("--model", options->model,
                      "YOLOX model (.onnx); else DKP_SLAM_MODEL, models/, ~/.cache/dkp-slam");
  auto* view = command->add_flag("--view", options->view,
                                 "Show both runs on a web page, whose address is printed");
  command->add_option("--port", options->port, "Port of the page; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->needs(view)
      ->capture_default_str();
  command->callback([options] { demo(*options); });
}

}  // namespace dkp_slam::apps
