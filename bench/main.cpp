// dkp-slam-bench: what developers measure of the parts of the system, one command each.

#include <exception>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "bench/benches.h"

int main(int argc, char** argv) {
  CLI::App program("Measures parts of dkp-slam, for its developers", "dkp-slam-bench");
  program.require_subcommand(1);
  dkp_slam::bench::add_dense(program);
  dkp_slam::bench::add_dynamics(program);
  dkp_slam::bench::add_loop(program);
  dkp_slam::bench::add_map(program);
  dkp_slam::bench::add_place(program);
  dkp_slam::bench::add_self_check(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "dkp-slam-bench: {}\n", error.what());
    return 1;
  }
  return 0;
}
