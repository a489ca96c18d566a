#include "dkp_slam/calibration/known_length.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "dkp_slam/calibration/sightings.h"
#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

constexpr double reach = 0.5;            // seconds before and after
constexpr double same_time = 0.005;      // seconds
constexpr double picked_sigma = 0.5;     // pixels
constexpr std::size_t least_depths = 5;  // with depth at both ends
constexpr double shared = 4.0;  // neighbouring frames' readings hang together by about so many

/// A frame near the image of the length.
struct Near {
  Se3 image_from_camera;  ///< the camera of the length's image from this one's
  double time_off = 0.0;  ///< seconds, from the length's image
  cv::Mat depth;
};

std::vector<Near> frames_near(const KnownLength& length, RgbdSource& source,
                              const Trajectory& path) {
  const auto at = std::min_element(path.begin(), path.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.timestamp - length.timestamp) < std::abs(b.timestamp - length.timestamp);
  });
  if (at == path.end() || std::abs(at->timestamp - length.timestamp) > same_time) {
    throw Error(
        fmt::format("length: {:.6f} is not the time stamp of a localised colour image of {}",
                    length.timestamp, source.description()));
  }
  std::map<double, Se3> poses;
  for (const StampedPose& p : path) poses.emplace(p.timestamp, p.world_from_camera);
  std::vector<Near> near;
  while (const auto frame = source.read()) {
    if (frame->timestamp > length.timestamp + reach) break;
    const auto pose = poses.find(frame->timestamp);
    if (frame->timestamp < length.timestamp - reach || pose == poses.end()) continue;
    near.push_back({at->world_from_camera.inverse() * pose->second,
                    frame->timestamp - length.timestamp, frame->depth});
  }
  return near;
}

/// Of the point behind a pixel of the length's image, by one frame's depth: where the ray of the
/// pixel meets the surface there. Metres along the ray's z; nothing where no flat depth is seen.
std::optional<double> depth_by(const Near& frame, const Camera& camera, const Eigen::Vector3d& ray,
                               double guess) {
  const Se3 camera_from_image = frame.image_from_camera.inverse();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d there = camera_from_image * (guess * ray);
    if (there.z() <= 0.0) return std::nullopt;
    const DepthPatch patch =
        fit_depth_patch(frame.depth, camera, camera.distort(camera.project(there)));
    if (!patch.known()) return std::nullopt;
    const Eigen::Vector2d raw = camera.distort(camera.project(there));
    const double z = 1.0 / (patch.inverse + patch.slope.dot(raw - patch.pixel));
    // Along the ray of the length's image, z there grows with the guess.
    const double by_guess = (camera_from_image.rotation * ray).z();
    if (by_guess < 0.3) return std::nullopt;
    guess += (z - there.z()) / by_guess;
  }
  return guess;
}

}  // namespace

KnownLength parse_known_length(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream fields(text);
  for (std::string field; std::getline(fields, field, ',');) {
    std::size_t used = 0;
    try {
      numbers.push_back(std::stod(field, &used));
    } catch (const std::exception&) {
      used = 0;
    }
    if (field.empty() || used != field.size() || !std::isfinite(numbers.back())) {
      throw Error(fmt::format("length \"{}\": \"{}\" is no number", text, field));
    }
  }
  if (numbers.size() != 6) {
    throw Error(
        fmt::format("length \"{}\": must be six numbers, TIMESTAMP,u1,v1,u2,v2,METRES", text));
  }
  KnownLength length;
  length.timestamp = numbers[0];
  length.pixels = {Eigen::Vector2d(numbers[1], numbers[2]),
                   Eigen::Vector2d(numbers[3], numbers[4])};
  length.metres = numbers[5];
  if (length.metres <= 0.0) {
    throw Error(fmt::format("length \"{}\": the distance must be above 0 metres", text));
  }
  return length;
}

MeasuredLength measure_length(const KnownLength& length, RgbdSource& source, const Camera& camera,
                              const Trajectory& path) {
  const std::vector<Near> near = frames_near(length, source, path);
  std::array<Eigen::Vector3d, 2> rays;
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Vector2d& p = length.pixels[i];
    const cv::Point2f pixel =
        camera.undistort({{static_cast<float>(p.x()), static_cast<float>(p.y())}}).front();
    rays[i] = camera.unproject({pixel.x, pixel.y}, 1.0);
  }
  const auto first = std::min_element(near.begin(), near.end(), [](const Near& a, const Near& b) {
    return std::abs(a.time_off) < std::abs(b.time_off);
  });
  std::array<double, 2> guess{};
  for (std::size_t i = 0; i < 2; ++i) {
    const DepthPatch patch = first == near.end()
                                 ? DepthPatch()
                                 : fit_depth_patch(first->depth, camera, length.pixels[i]);
    if (!patch.known()) {
      throw Error(fmt::format(
          "length: no flat surface with depth around pixel ({:g}, {:g}) of the image at {:.6f}; "
          "choose points within flat surfaces, such as marks on a wall or a poster",
          length.pixels[i].x(), length.pixels[i].y(), length.timestamp));
    }
    guess[i] = 1.0 / patch.inverse;
  }
  std::vector<double> distances;
  for (const Near& frame : near) {
    const auto a = depth_by(frame, camera, rays[0], guess[0]);
    const auto b = depth_by(frame, camera, rays[1], guess[1]);
    if (a && b) distances.push_back((*a * rays[0] - *b * rays[1]).norm());
  }
  if (distances.size() < least_depths) {
    throw Error(
        fmt::format("length: only {} frames near {:.6f} see both points with depth; {} are "
                    "needed; choose an image where the camera moves slowly",
                    distances.size(), length.timestamp, least_depths));
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double median = *middle;
  double sum = 0.0, squares = 0.0;
  int count = 0;
  for (double d : distances) {
    if (std::abs(d - median) > 0.05 * median) continue;
    sum += d;
    squares += (d - median) * (d - median);
    ++count;
  }
  MeasuredLength out;
  out.metres = sum / count;
  out.frames = count;
  const double scatter = squares / count * shared / count;
  const double picked = picked_sigma * std::hypot(guess[0], guess[1]) / camera.fx;
  out.sigma = std::sqrt(scatter + picked * picked);
  return out;
}

}  // namespace dkp_slam
