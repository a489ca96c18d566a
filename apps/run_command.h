#pragma once

#include "apps/run_options.h"

namespace dkp_slam::apps {

/// `dkp-slam run`. Throws as a subcommand does.
void run(RunOptions options);

}  // namespace dkp_slam::apps
