// Stands in where libfreenect is not installed.
#include "dkp_slam/error.h"
#include "dkp_slam/sensor/kinect/kinect_source.h"

namespace dkp_slam {

bool can_read_kinects() { return false; }

std::unique_ptr<KinectSource> open_kinect(const KinectOptions&) {
  throw Error(
      "kinect: this program was built without libfreenect; install it with `scripts/setup.sh "
      "--with kinect` (libfreenect-dev) and build again");
}

}  // namespace dkp_slam
