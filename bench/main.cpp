// dkp-slam-bench: what developers measure of the parts of the system, one command each.

#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "bench/benches.h"

namespace {

int run(int argc, char** argv) {
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
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "dkp-slam-bench: %s\n", error.what());
    return 1;
  }
}
