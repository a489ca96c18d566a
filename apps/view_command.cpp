#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/progress.h"
#include "apps/run_command.h"
#include "apps/run_view.h"
#include "apps/source_choice.h"
#include "dkp_slam/error.h"
#include "dkp_slam/map/map_changes.h"
#include "dkp_slam/map_file/map_file.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

struct ViewArguments {
  RunOptions run;
  bool once = false;
};

/// A folder for what nobody wants to keep, gone with it.
class PassingFolder {
 public:
  PassingFolder() {
    std::string name = (fs::temp_directory_path() / "dkp-slam-view.XXXXXX").string();
    if (!mkdtemp(name.data())) {
      throw Error(fmt::format("cannot make a folder in {}; name one with --out",
                              fs::temp_directory_path().string()));
    }
    path_ = name;
  }
  ~PassingFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  PassingFolder(const PassingFolder&) = delete;
  PassingFolder& operator=(const PassingFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void view_map(const ViewArguments& arguments) {
  catch_interrupts();
  const StoredMap stored = read_map(arguments.run.sequence);
  viewer::SceneInfo info;
  info.kind = "map";
  info.title = stored.file.filename().string();
  info.facts = {{"file", stored.file.string()},
                {"written by", "dkp-slam " + stored.program_version},
                {"keyframes", std::to_string(stored.map.live_keyframes())},
                {"landmarks", std::to_string(stored.map.live_landmarks())}};
  info.camera = stored.map.camera();
  const LiveView view(arguments.run.view, std::move(info), false);
  view.scene().apply(ChangeFinder().find(stored.map));
  view.scene().finish({});
  if (!arguments.once) view.stay();
}

void view_sequence(const ViewArguments& arguments) {
  RunOptions options = arguments.run;
  options.view.wanted = true;
  options.view.stay = !arguments.once;
  if (!options.out.empty()) return run(std::move(options));
  const PassingFolder folder;
  options.out = folder.path();
  run(std::move(options));
}

/// Throws CLI::ValidationError where an option was given that only a sequence has.
void check_for_map(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (option->count() > 0 && name != "SEQUENCE|MAP" && name != "--port" && name != "--listen" &&
        name != "--once") {
      throw CLI::ValidationError(name, "is for a sequence, and what is to be shown is a map file");
    }
  }
}

}  // namespace

void add_view_command(CLI::App& program) {
  const auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command = program.add_subcommand(
      "view",
      "Show a run on a web page while it lasts and after it, or what a map file holds; see "
      "docs/view.md. Prints the page's address and ends with Ctrl-C.");
  command
      ->add_option("SEQUENCE|MAP", arguments->run.sequence,
                   "Folder of images, ROS 1 bag, kinect or - for a frame stream on the standard "
                   "input, which is run as by `dkp-slam run`, or a map file")
      ->required();
  add_server_options(*command, arguments->run.view);
  command->add_flag("--paused", arguments->run.view.paused,
                    "Begin paused, until the page says go on (not with --realtime)");
  command->add_flag("--once", arguments->once, "End when the sequence does");
  command->add_option("--out", arguments->run.out,
                      "Folder for the results, as of a run; without it none are kept");
  add_run_options(*command, arguments->run);
  add_dense_file_options(*command, arguments->run.dense);
  command->callback([arguments, command] {
    if (fs::is_regular_file(arguments->run.sequence) && !is_bag_file(arguments->run.sequence)) {
      check_for_map(*command);
      view_map(*arguments);
    } else {
      view_sequence(*arguments);
    }
  });
}

}  // namespace dkp_slam::apps
