#include "dkp_slam/synth/tracing/shutter.h"

#include <tuple>

namespace dkp_slam {
namespace {

auto key(const Camera& c) {
  const Distortion& d = c.distortion;
  return std::make_tuple(c.width, c.height, c.fx, c.fy, c.cx, c.cy, d.k1, d.k2, d.p1, d.p2, d.k3);
}

}  // namespace

PixelRays::PixelRays(const Camera& camera) : camera_(camera) {
  std::vector<cv::Point2f> pixels;
  for (int y = -1; y <= camera.height; ++y) {
    for (int x = -1; x <= camera.width; ++x) {
      pixels.emplace_back(static_cast<float>(x), static_cast<float>(y));
    }
  }
  if (!camera.distortion.none()) pixels = camera.undistort(pixels);
  directions_.reserve(pixels.size());
  for (const cv::Point2f& p : pixels) {
    directions_.emplace_back(static_cast<float>((p.x - camera.cx) / camera.fx),
                             static_cast<float>((p.y - camera.cy) / camera.fy));
  }
}

bool PixelRays::made_for(const Camera& camera) const { return key(camera) == key(camera_); }

Shutter::Shutter(const std::function<Se3(double)>& world_from_camera, int rows, double time,
                 double exposure, double readout)
    : exposure_(exposure),
      begin_(time - 0.5 * readout - 0.5 * exposure),
      end_(time + 0.5 * readout + 0.5 * exposure) {
  rows_.reserve(static_cast<std::size_t>(rows));
  for (int y = 0; y < rows; ++y) {
    if (readout == 0.0 && y > 0) {
      rows_.push_back(rows_.front());
      continue;
    }
    RowExposure row;
    row.time = time + (rows > 1 ? static_cast<double>(y) / (rows - 1) - 0.5 : 0.0) * readout;
    row.middle = CameraPlace(world_from_camera(row.time));
    row.begin = row.end = row.middle;
    if (exposure > 0.0) {
      row.begin = CameraPlace(world_from_camera(row.time - 0.5 * exposure));
      row.end = CameraPlace(world_from_camera(row.time + 0.5 * exposure));
    }
    rows_.push_back(row);
  }
}

}  // namespace dkp_slam
