#include <cstdio>
#include <iostream>
#include <sstream>

#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/process.h"
#include "apps/progress.h"
#include "dkp_slam/version.h"

namespace {

constexpr int exit_failure = 1;
constexpr int exit_usage = 2;
constexpr int exit_interrupted = 130;

}  // namespace

int main(int argc, char** argv) {
  dkp_slam::apps::prepare_process();
  dkp_slam::apps::log_to_stderr();
  CLI::App program(
      "Visual SLAM for rooms with people in them: colour and depth images in, camera "
      "trajectory and a map of the static world out.",
      "dkp-slam");
  program.set_version_flag("--version", DKP_SLAM_VERSION);
  program.require_subcommand(1);
  dkp_slam::apps::add_run_command(program);
  dkp_slam::apps::add_detect_command(program);
  dkp_slam::apps::add_eval_command(program);
  dkp_slam::apps::add_synth_command(program);
  dkp_slam::apps::add_bench_command(program);
  dkp_slam::apps::add_demo_command(program);
  dkp_slam::apps::add_view_command(program);
  dkp_slam::apps::add_map_command(program);
  dkp_slam::apps::add_export_command(program);
  dkp_slam::apps::add_record_command(program);
  dkp_slam::apps::add_stream_command(program);
  dkp_slam::apps::add_calibrate_command(program);
  dkp_slam::apps::add_config_command(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream message;
    const int code = program.exit(error, std::cout, message);
    std::fputs(dkp_slam::apps::printable(message.str()).c_str(), stderr);
    return code == 0 ? 0 : exit_usage;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "dkp-slam: %s\n",
                 dkp_slam::apps::one_line(dkp_slam::apps::message_of(error)).c_str());
    return dkp_slam::apps::interrupted() ? exit_interrupted : exit_failure;
  }
  return 0;
}
