#pragma once

#include <CLI/CLI.hpp>

#include "apps/run_options.h"

namespace dkp_slam::apps {

/// Adds every option of `dkp-slam run` but for --out and those of the view.
void add_run_options(CLI::App& command, RunOptions& options);

/// `dkp-slam run`. Throws as a subcommand does.
void run(RunOptions options);

}  // namespace dkp_slam::apps
