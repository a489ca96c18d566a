#pragma once

#include "dkp_slam/system/config.h"

namespace dkp_slam::python {

/// dkp_slam.Config: a configuration by its options' names.
struct ConfigObject {
  SlamConfig config;
};

}  // namespace dkp_slam::python
