#include "dkp_slam/feature/frame_features.h"

#include <algorithm>
#include <cmath>

#include "dkp_slam/geometry/depth_at.h"
#include "dkp_slam/geometry/rolling_shutter.h"

namespace dkp_slam {
namespace {

/// Depth at the colour image's moment of a feature, read from a depth image of another moment: the
/// feature's place there follows from a first reading at its own pixel.
float carried_depth(const cv::Mat& depth, const Camera& camera, const Se3& depth_from_colour,
                    const cv::Point2f& pixel, const cv::Point2f& raw_pixel) {
  const float first = depth_at(depth, raw_pixel);
  if (first <= 0.0F) return 0.0F;
  const Eigen::Vector3d there = depth_from_colour * camera.unproject({pixel.x, pixel.y}, first);
  if (there.z() <= 0.0) return 0.0F;
  const Eigen::Vector2d place = camera.project(there);
  const Eigen::Vector2d raw_place = camera.distort(place);
  const float second = depth_at(depth, {float(raw_place.x()), float(raw_place.y())});
  if (second <= 0.0F) return 0.0F;
  return static_cast<float>((depth_from_colour.inverse() * camera.unproject(place, second)).z());
}

template <class T>
std::vector<T> selected(const std::vector<T>& all, const std::vector<char>& keep) {
  std::vector<T> out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (keep[i]) out.push_back(all[i]);
  }
  return out;
}

}  // namespace

FrameFeatures::FrameFeatures(const OrbFeatures& orb, const cv::Mat& depth_image,
                             const Camera& camera, const Se3& depth_from_colour)
    : descriptor(orb.descriptors),
      columns_(camera.width / cell + 1),
      rows_(camera.height / cell + 1) {
  raw_pixel.reserve(orb.keypoints.size());
  for (const cv::KeyPoint& k : orb.keypoints) {
    raw_pixel.push_back(k.pt);
    level.push_back(static_cast<std::uint8_t>(k.octave));
    angle.push_back(k.angle);
  }
  pixel = camera.undistort(raw_pixel);
  seen_pixel = pixel;
  const bool moved = depth_from_colour.log().norm() > 1e-6;
  for (std::size_t i = 0; i < pixel.size(); ++i) {
    depth.push_back(
        moved ? carried_depth(depth_image, camera, depth_from_colour, pixel[i], raw_pixel[i])
              : depth_at(depth_image, raw_pixel[i]));
  }
  seen_depth = depth;
  build_grid();
}

FrameFeatures::FrameFeatures(const Camera& camera, std::vector<cv::Point2f> pixels,
                             std::vector<float> depths, std::vector<std::uint8_t> levels,
                             std::vector<float> angles, std::vector<Descriptor> descriptors)
    : pixel(std::move(pixels)),
      seen_pixel(pixel),
      depth(std::move(depths)),
      seen_depth(depth),
      level(std::move(levels)),
      angle(std::move(angles)),
      descriptor(std::move(descriptors)),
      columns_(camera.width / cell + 1),
      rows_(camera.height / cell + 1) {
  raw_pixel.reserve(pixel.size());
  for (const cv::Point2f& p : pixel) {
    const Eigen::Vector2d raw = camera.distort({p.x, p.y});
    raw_pixel.emplace_back(static_cast<float>(raw.x()), static_cast<float>(raw.y()));
  }
  build_grid();
}

std::size_t FrameFeatures::memory() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
  return bytes(pixel) + bytes(seen_pixel) + bytes(raw_pixel) + bytes(depth) + bytes(seen_depth) +
         bytes(level) + bytes(angle) + bytes(descriptor) + bytes(cell_start_) +
         bytes(cell_members_);
}

FrameFeatures FrameFeatures::subset(const std::vector<char>& keep) const {
  FrameFeatures out;
  out.pixel = selected(pixel, keep);
  out.seen_pixel = selected(seen_pixel, keep);
  out.raw_pixel = selected(raw_pixel, keep);
  out.depth = selected(depth, keep);
  out.seen_depth = selected(seen_depth, keep);
  out.level = selected(level, keep);
  out.angle = selected(angle, keep);
  out.descriptor = selected(descriptor, keep);
  out.columns_ = columns_;
  out.rows_ = rows_;
  out.build_grid();
  return out;
}

void FrameFeatures::correct_rolling_shutter(const Camera& camera, const Vector6d& velocity) {
  for (std::size_t i = 0; i < pixel.size(); ++i) {
    const ImagePoint seen{seen_pixel[i], seen_depth[i]};
    const ImagePoint middle = at_middle_row(camera, seen, raw_pixel[i].y, velocity);
    pixel[i] = middle.pixel;
    depth[i] = middle.depth;
  }
  build_grid();
}

void FrameFeatures::build_grid() {
  const auto cell_of = [&](const cv::Point2f& p) {
    const int c = std::clamp(static_cast<int>(p.x) / cell, 0, columns_ - 1);
    const int r = std::clamp(static_cast<int>(p.y) / cell, 0, rows_ - 1);
    return static_cast<std::size_t>(r * columns_ + c);
  };
  cell_start_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  for (const cv::Point2f& p : pixel) ++cell_start_[cell_of(p) + 1];
  for (std::size_t i = 1; i < cell_start_.size(); ++i) cell_start_[i] += cell_start_[i - 1];
  cell_members_.resize(pixel.size());
  std::vector<std::int32_t> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < pixel.size(); ++i) {
    cell_members_[static_cast<std::size_t>(next[cell_of(pixel[i])]++)] =
        static_cast<std::int32_t>(i);
  }
}

void FrameFeatures::find(const cv::Point2f& centre, float radius, int lowest_level,
                         int highest_level, std::vector<int>& out) const {
  out.clear();
  const int c0 =
      std::clamp(static_cast<int>(std::floor((centre.x - radius) / cell)), 0, columns_ - 1);
  const int c1 =
      std::clamp(static_cast<int>(std::floor((centre.x + radius) / cell)), 0, columns_ - 1);
  const int r0 = std::clamp(static_cast<int>(std::floor((centre.y - radius) / cell)), 0, rows_ - 1);
  const int r1 = std::clamp(static_cast<int>(std::floor((centre.y + radius) / cell)), 0, rows_ - 1);
  for (int r = r0; r <= r1; ++r) {
    const auto first = static_cast<std::size_t>(r * columns_ + c0);
    const auto last = static_cast<std::size_t>(r * columns_ + c1);
    for (std::int32_t k = cell_start_[first]; k < cell_start_[last + 1]; ++k) {
      const int i = cell_members_[static_cast<std::size_t>(k)];
      const auto s = static_cast<std::size_t>(i);
      if (level[s] < lowest_level || level[s] > highest_level) continue;
      if (std::abs(pixel[s].x - centre.x) > radius || std::abs(pixel[s].y - centre.y) > radius)
        continue;
      out.push_back(i);
    }
  }
}

}  // namespace dkp_slam
