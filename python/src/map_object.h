#pragma once

#include <memory>

#include "dkp_slam/map/map.h"

namespace dkp_slam::python {

/// dkp_slam.Map: a map that nobody changes any more. Looking at it may bring it up to date, so that
/// it is done with the GIL held.
struct MapObject {
  std::shared_ptr<const Map> map;
};

}  // namespace dkp_slam::python
