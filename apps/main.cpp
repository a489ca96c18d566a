#include <cstdio>
#include <exception>
#include <iostream>
#include <sstream>

#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/process.h"
#include "apps/progress.h"
#include "dkp_slam/version.h"

namespace dkp_slam::apps {
namespace {

constexpr int exit_failure = 1;
constexpr int exit_usage = 2;
constexpr int exit_interrupted = 130;

/// Everything may throw, what is done first included: memory can run out anywhere.
int run_program(int argc, char** argv) {
  prepare_process();
  log_to_stderr();
  CLI::App program(
      "Visual SLAM for rooms with people in them: colour and depth images in, camera "
      "trajectory and a map of the static world out.",
      "dkp-slam");
  program.set_version_flag("--version", DKP_SLAM_VERSION);
  program.require_subcommand(1);
  add_run_command(program);
  add_detect_command(program);
  add_eval_command(program);
  add_synth_command(program);
  add_bench_command(program);
  add_demo_command(program);
  add_view_command(program);
  add_map_command(program);
  add_export_command(program);
  add_record_command(program);
  add_stream_command(program);
  add_calibrate_command(program);
  add_config_command(program);
  add_doctor_command(program);
  add_help_command(program);
  add_completion_command(program);
  add_man_command(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream message;
    const int code = program.exit(error, std::cout, message);
    std::fputs(printable(message.str()).c_str(), stderr);
    return code == 0 ? 0 : exit_usage;
  }
  return 0;
}

void tell(const std::exception& error) {
  try {
    std::fprintf(stderr, "dkp-slam: %s\n", one_line(message_of(error)).c_str());
  } catch (const std::exception&) {
    std::fputs("dkp-slam: out of memory\n", stderr);  // which is why nothing more can be said
  }
}

}  // namespace
}  // namespace dkp_slam::apps

int main(int argc, char** argv) {
  using namespace dkp_slam::apps;
  try {
    return run_program(argc, argv);
  } catch (const std::exception& error) {
    tell(error);
    return interrupted() ? exit_interrupted : exit_failure;
  }
}
