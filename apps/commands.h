#pragma once

#include <CLI/CLI.hpp>

namespace dkp_slam::apps {

/// Each adds its subcommand to the program. The subcommand's callback does the work and throws
/// dkp_slam::Error on failure (exit code 1) or CLI::ValidationError on misuse (exit code 2).
void add_run_command(CLI::App& program);
void add_detect_command(CLI::App& program);
void add_eval_command(CLI::App& program);
void add_synth_command(CLI::App& program);
void add_bench_command(CLI::App& program);
void add_demo_command(CLI::App& program);
void add_view_command(CLI::App& program);
void add_map_command(CLI::App& program);
void add_export_command(CLI::App& program);
void add_record_command(CLI::App& program);
void add_stream_command(CLI::App& program);
void add_calibrate_command(CLI::App& program);
void add_config_command(CLI::App& program);
void add_doctor_command(CLI::App& program);
/// These three tell of all commands of `program`, which they refer to.
void add_help_command(CLI::App& program);
void add_completion_command(CLI::App& program);
void add_man_command(CLI::App& program);

}  // namespace dkp_slam::apps
