#pragma once

#include <CLI/CLI.hpp>

namespace dkp_slam::bench {

// Each adds one measurement to the program, as a command; each has a source of its own.
void add_dense(CLI::App& program);
void add_dynamics(CLI::App& program);
void add_loop(CLI::App& program);
void add_map(CLI::App& program);
void add_place(CLI::App& program);
void add_self_check(CLI::App& program);

}  // namespace dkp_slam::bench
