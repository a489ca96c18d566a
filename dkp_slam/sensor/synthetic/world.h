#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/geometry/se3.h"
#include "dkp_slam/sensor/synthetic/person.h"
#include "dkp_slam/sensor/synthetic/room.h"

namespace dkp_slam {

/// What a camera in the synthetic world sees, without any noise.
struct Rendering {
  cv::Mat colour;  ///< CV_8UC3, BGR, edges and textures free of aliasing
  cv::Mat depth;   ///< CV_32FC1, metres along z, of the ray through each pixel's centre
  cv::Mat mask;    ///< CV_8UC1, 255 where that ray hits a person
};

/// A furnished room with people who walk in it, all of it made from a seed.
class SyntheticWorld {
 public:
  SyntheticWorld(std::uint64_t seed, int people);

  /// Casts a ray per pixel, several where surfaces meet. `camera` must have no lens distortion.
  Rendering render(const Camera& camera, const Se3& world_from_camera, double time) const;

 private:
  std::vector<Panel> panels_;
  std::vector<Person> people_;
};

}  // namespace dkp_slam
