#include "dkp_slam/dense/dense_map.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <opencv2/core/utility.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

constexpr int side = BlockGrid<Voxel>::side;
constexpr double bytes_per_megabyte = 1e6;
/// Pixels left out on the way to room: neighbours lie in the same blocks.
constexpr int reserve_step = 2;
/// Of the truncation: so far from what lies in a mask a voxel is of the same thing.
constexpr float moving_reach = 0.5F;
constexpr float nearest_point = 0.05F;  // metres before the camera

std::size_t most_blocks(double megabytes) {
  // The table that finds a block adds to it.
  constexpr double bytes = sizeof(BlockGrid<Voxel>::Block) + 80.0;
  return static_cast<std::size_t>(std::max(1.0, megabytes * bytes_per_megabyte / bytes));
}

DenseMapOptions checked(DenseMapOptions options) {
  if (!(options.voxel >= 0.005 && options.voxel <= 0.2)) {
    throw Error(
        fmt::format("dense map: a voxel of {} m is not between 0.005 and 0.2 m", options.voxel));
  }
  if (!(options.memory >= 1.0 && options.memory <= 1e6)) {
    throw Error(
        fmt::format("dense map: memory of {} MB is not between 1 and 1000000 MB", options.memory));
  }
  if (!(options.forgetting > 0.0 && options.forgetting < 1.0) || !(options.most_views >= 1.0) ||
      !(options.truncation > 0.0)) {
    throw Error("dense map: forgetting must be in 0..1, views at least 1, truncation above 0");
  }
  options.truncation = std::max(options.truncation, 3.0 * options.voxel);
  return options;
}

/// Mean of what the views saw, in 1/256 grey levels.
void add_colour(Voxel& voxel, const cv::Vec3b& bgr) {
  constexpr int most = 200;
  const int n = std::min<int>(voxel.colours + 1, most);
  for (int c = 0; c < 3; ++c) {
    const int mean = voxel.colour[c], seen = bgr[c] * 256;
    voxel.colour[c] = static_cast<std::uint16_t>(mean + (seen - mean) / n);
  }
  voxel.colours = static_cast<std::uint16_t>(n);
}

}  // namespace

/// Where a view sees points of the world, and how it judges depth.
struct DenseMap::Projection {
  Projection(const Camera& camera, const StaticView& from, double truncation)
      : view(from),
        fx(static_cast<float>(camera.fx)),
        fy(static_cast<float>(camera.fy)),
        cx(static_cast<float>(camera.cx)),
        cy(static_cast<float>(camera.cy)),
        row_time(static_cast<float>(camera.readout_of_depth() / camera.height)),
        middle_row(0.5F * static_cast<float>(camera.height)),
        width(static_cast<float>(camera.width)),
        height(static_cast<float>(camera.height)),
        truncation(static_cast<float>(truncation)),
        noise(camera.depth_noise),
        reference(camera.depth_noise.sigma(0.5)) {
    const Se3 camera_from_world = from.world_from_camera.inverse();
    rotation = camera_from_world.rotation.toRotationMatrix().cast<float>();
    translation = camera_from_world.translation.cast<float>();
    speed = from.velocity.head<3>().cast<float>();
    spin = from.velocity.tail<3>().cast<float>();
  }

  Eigen::Vector3f in_camera(const Eigen::Vector3f& world) const {
    return rotation * world + translation;
  }
  /// The same point at the moment of the row in which it is seen.
  Eigen::Vector3f at_its_row(const Eigen::Vector3f& p) const {
    if (row_time == 0.0F) return p;
    const float row = fy * p.y() / p.z() + cy;
    return p - (row - middle_row) * row_time * (speed + spin.cross(p));
  }
  /// Of a point before the camera; false where it is not in view.
  bool pixel(const Eigen::Vector3f& p, int& u, int& v) const {
    const float inverse = 1.0F / p.z();
    const float x = fx * p.x() * inverse + cx + 0.5F, y = fy * p.y() * inverse + cy + 0.5F;
    if (!(x >= 0.0F && y >= 0.0F && x < width && y < height)) return false;
    u = static_cast<int>(x);
    v = static_cast<int>(y);
    return true;
  }
  float weight(float depth) const {
    const auto ratio = static_cast<float>(reference / noise.sigma(depth));
    return ratio * ratio;
  }
  /// False where no part of a ball can be in view, or it is too far to matter.
  bool sees(const Eigen::Vector3f& p, float radius) const {
    if (p.z() < -radius) return false;
    if (p.z() <= 2.0F * radius) return true;
    const float u = fx * p.x() / p.z() + cx, v = fy * p.y() / p.z() + cy;
    const float margin = 2.0F * std::max(fx, fy) * radius / p.z();
    return u > -margin && v > -margin && u < width + margin && v < height + margin;
  }

  const StaticView& view;
  float fx, fy, cx, cy;
  float row_time, middle_row;  ///< seconds from row to row
  float width, height;         ///< pixels
  float truncation;
  DepthNoise noise;
  double reference;
  Eigen::Matrix3f rotation;
  Eigen::Vector3f translation, speed, spin;
};

DenseMap::DenseMap(const Camera& camera, const DenseMapOptions& options)
    : camera_(camera), options_(checked(options)), grid_(most_blocks(options.memory)) {}

double DenseMap::megabytes() const {
  return static_cast<double>(grid_.size() * sizeof(BlockGrid<Voxel>::Block)) / bytes_per_megabyte;
}

void DenseMap::reserve(const StaticView& view) {
  const double block = options_.voxel * side, reach = options_.truncation + options_.voxel;
  // Half a block from step to step misses corners only.
  const int steps = std::max(1, static_cast<int>(std::ceil(2.0 * reach / (0.5 * block))));
  const Eigen::Matrix3d rotation = view.world_from_camera.rotation.toRotationMatrix();
  Eigen::Vector3i last(1 << 30, 0, 0);
  for (int v = 0; v < view.surface.rows; v += reserve_step) {
    const auto* row = view.surface.ptr<float>(v);
    for (int u = 0; u < view.surface.cols; u += reserve_step) {
      if (row[u] <= 0.0F) continue;
      const Eigen::Vector3d ray = rotation * camera_.unproject({double(u), double(v)}, 1.0);
      for (int i = 0; i <= steps; ++i) {
        const double depth = row[u] - reach + 2.0 * reach * i / steps;
        const Eigen::Vector3d p = view.world_from_camera.translation + depth * ray;
        const Eigen::Vector3i place = (p / block).array().floor().cast<int>();
        if (place == last) continue;
        last = place;
        full_ = !grid_.add(place) || full_;
      }
    }
  }
}

void DenseMap::fuse(const StaticView& view) {
  const Projection to(camera_, view, options_.truncation);
  cv::parallel_for_(cv::Range(0, static_cast<int>(grid_.size())), [&](const cv::Range& blocks) {
    for (int b = blocks.start; b < blocks.end; ++b) fuse_block(to, static_cast<std::size_t>(b));
  });
}

void DenseMap::fuse(const StaticView& view, std::span<const std::size_t> blocks) {
  const Projection to(camera_, view, options_.truncation);
  for (const std::size_t b : blocks) fuse_block(to, b);
}

std::vector<std::size_t> DenseMap::in_view(const Se3& world_from_camera, double farthest,
                                           std::span<const std::size_t> blocks) const {
  StaticView from;
  from.world_from_camera = world_from_camera;
  const Projection to(camera_, from, options_.truncation);
  const auto size = static_cast<float>(options_.voxel * side);
  const float radius = 0.875F * size, reach = static_cast<float>(farthest) + to.truncation + radius;
  std::vector<std::size_t> seen;
  for (const std::size_t b : blocks) {
    const Eigen::Vector3f middle =
        to.in_camera((grid_.place(b).cast<float>().array() + 0.5F).matrix() * size);
    if (middle.z() < reach && to.sees(middle, radius)) seen.push_back(b);
  }
  return seen;
}

void DenseMap::clear(std::size_t block) { grid_.block(block).fill({}); }

void DenseMap::fuse_block(const Projection& to, std::size_t block) {
  const auto voxel_size = static_cast<float>(options_.voxel);
  const Eigen::Vector3f first =
      to.in_camera(grid_.place(block).cast<float>() * (voxel_size * side));
  const Eigen::Matrix3f step = to.rotation * voxel_size;
  constexpr float half = 0.5F * (side - 1);
  if (!to.sees(first + step * Eigen::Vector3f::Constant(half), half * 1.75F * voxel_size)) return;
  const StaticView& view = to.view;
  Voxel* at = grid_.block(block).data();
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      Eigen::Vector3f next =
          first + static_cast<float>(y) * step.col(1) + static_cast<float>(z) * step.col(2);
      for (int x = 0; x < side; ++x, ++at, next += step.col(0)) {
        if (next.z() <= nearest_point) continue;
        const Eigen::Vector3f p = to.at_its_row(next);
        int u = 0, v = 0;
        if (!to.pixel(p, u, v)) continue;
        if (!view.moving.empty() &&
            std::abs(view.moving.ptr<float>(v)[u] - p.z()) < moving_reach * to.truncation) {
          see_moving(*at);
          continue;
        }
        const float nearest = view.nearest.ptr<float>(v)[u], depth = view.surface.ptr<float>(v)[u];
        if (nearest - p.z() > to.truncation) {
          see_through(*at);
          continue;
        }
        const float distance = depth - p.z();
        if (depth <= 0.0F || std::abs(distance) > to.truncation) continue;
        see_surface(*at, distance, to.weight(depth));
        if (std::abs(distance) < 1.5F * voxel_size) {
          add_colour(*at, view.colour.ptr<cv::Vec3b>(v)[u]);
        }
      }
    }
  }
}

void DenseMap::see_through(Voxel& voxel) const {
  const auto kept = 1.0F - static_cast<float>(options_.forgetting);
  voxel.seen_through = std::min(voxel.seen_through + 1.0F, static_cast<float>(options_.most_views));
  voxel.hits *= kept;
  voxel.weight *= kept;
  voxel.moving *= kept;
}

void DenseMap::see_moving(Voxel& voxel) const {
  voxel.moving = std::min(voxel.moving + 1.0F, static_cast<float>(options_.most_views));
}

void DenseMap::see_surface(Voxel& voxel, float distance, float weight) const {
  const auto size = static_cast<float>(options_.voxel);
  const auto truncation = static_cast<float>(options_.truncation);
  // Behind a surface nobody has looked: the deeper, the less is known (Bylow et al., "Real-Time
  // Camera Tracking and 3D Reconstruction Using Signed Distance Functions", RSS 2013).
  const float share = distance >= -size ? 1.0F : (truncation + distance) / (truncation - size);
  weight *= share;
  if (weight <= 0.0F) return;
  voxel.distance += (distance - voxel.distance) * weight / (voxel.weight + weight);
  voxel.weight += weight;
  voxel.hits += share;
  voxel.seen_through *= 1.0F - static_cast<float>(options_.forgetting) * share;
  if (const auto most = static_cast<float>(options_.most_views); voxel.hits > most) {
    voxel.weight *= most / voxel.hits;
    voxel.hits = most;
  }
}

}  // namespace dkp_slam
