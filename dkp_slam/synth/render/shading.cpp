#include "dkp_slam/synth/render/shading.h"

#include <algorithm>
#include <cmath>

namespace dkp_slam {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

// Slopes beyond this only make the footprint at silhouettes grow without bound.
constexpr float flattest_view = 0.03F;
constexpr float still = 0.3F;         // pixels: a way over the exposure that none sees
constexpr float blurring = 2.0F;      // pixels: one that takes more than a pixel's filter
constexpr int most_motion_taps = 12;  // of a texture along its motion
constexpr int most_filter_taps = 6;   // of a texture across a slanted view
constexpr int few_taps = 2;           // of them, where several share the work

}  // namespace

void HitPlanes::look_up(int surface_index, int triangle) {
  surface_ = surface_index;
  triangle_ = triangle;
  const Surface& surface = scene_.surface(surface_index);
  const Mesh& mesh = *surface.mesh;
  const Eigen::Vector3i& t = mesh.triangles[static_cast<std::size_t>(triangle)];
  const auto corner = [&](const auto& of, int i) -> const auto& {
    return of[static_cast<std::size_t>(t[i])];
  };
  const std::vector<Vector3f>& vertices = surface.pose().vertices;
  const Vector3f a = corner(vertices, 1) - corner(vertices, 0);
  const Vector3f b = corner(vertices, 2) - corner(vertices, 0);
  const Vector3f cross = a.cross(b);
  const float inverse = 1.0F / std::max(cross.squaredNorm(), 1e-20F);
  const Vector3f along_a = b.cross(cross) * inverse, along_b = cross.cross(a) * inverse;
  along_first_ = corner(mesh.uv, 1) - corner(mesh.uv, 0);
  along_second_ = corner(mesh.uv, 2) - corner(mesh.uv, 0);
  corner_uv_ = corner(mesh.uv, 0);
  plane_.normal = cross * std::sqrt(inverse);
  plane_.gradient_u = along_first_.x() * along_a + along_second_.x() * along_b;
  plane_.gradient_v = along_first_.y() * along_a + along_second_.y() * along_b;
}

const HitPlane& HitPlanes::at(const SurfaceHit& hit, const Ray& ray) {
  if (hit.surface != surface_ || hit.triangle != triangle_) look_up(hit.surface, hit.triangle);
  plane_.point = ray.origin + hit.distance * ray.direction;
  plane_.uv = corner_uv_ + hit.u * along_first_ + hit.v * along_second_;
  const Surface& surface = scene_.surface(hit.surface);
  if (surface.instance != 0) {
    const Eigen::Vector3i& t = surface.mesh->triangles[static_cast<std::size_t>(hit.triangle)];
    const auto at = [&](const std::vector<Vector3f>& of) {
      const auto corner = [&](int i) -> const auto& { return of[static_cast<std::size_t>(t[i])]; };
      return Vector3f((1.0F - hit.u - hit.v) * corner(0) + hit.u * corner(1) + hit.v * corner(2));
    };
    plane_.travel = at(surface.last) - at(surface.first);
  } else {
    plane_.travel.setZero();
  }
  return plane_;
}

Footprint footprint(const HitPlane& plane, float distance, const Vector3f& direction,
                    const Vector3f& right, const Vector3f& down, const Vector2f& motion) {
  float slope = plane.normal.dot(direction);
  if (std::abs(slope) < flattest_view) slope = slope < 0.0F ? -flattest_view : flattest_view;
  const Vector3f forward = direction * (1.0F / slope);
  const auto on_texture = [&](const Vector3f& change) {
    const Vector3f step = distance * (change - plane.normal.dot(change) * forward);
    return Vector2f(plane.gradient_u.dot(step), plane.gradient_v.dot(step));
  };
  Footprint result;
  result.right = on_texture(right);
  result.down = on_texture(down);
  // A surface that moves to the right passes its left parts by the pixel; the sign does not matter.
  result.motion = motion.x() * result.right + motion.y() * result.down;
  return result;
}

Shading::Filter Shading::filter(int surface, const Footprint& footprint, int most_taps) const {
  const Texture& texture = *scene_.surface(surface).mesh->texture;
  return {texture.filter(footprint.right, footprint.down, most_taps), Vector2f::Zero(), 1};
}

Shading::Filter Shading::filter(int surface, const Footprint& footprint,
                                const Vector2f& way) const {
  const float length = way.norm();
  if (length >= blurring) {
    // Where motion blurs the print there is no fine detail to lose across the view.
    Filter blurred = filter(surface, footprint, few_taps);
    blurred.motion = footprint.motion;
    blurred.taps = std::min(static_cast<int>(std::ceil(length)), most_motion_taps);
    return blurred;
  }
  if (length <= still) return filter(surface, footprint, most_filter_taps);
  // A short way only lengthens the pixel, by its variance.
  const Vector2f along = way / length;
  const float longer = std::sqrt(1.0F + length * length);
  return filter(surface,
                {longer * (along.x() * footprint.right + along.y() * footprint.down),
                 along.x() * footprint.down - along.y() * footprint.right, footprint.motion},
                most_filter_taps);
}

cv::Vec3f Shading::colour(const SurfaceHit& hit, const Vector2f& uv, const Filter& filter,
                          const PixelLight& pixel) const {
  const Surface& surface = scene_.surface(hit.surface);
  const Mesh& mesh = *surface.mesh;
  cv::Vec3f print(0.0F, 0.0F, 0.0F);
  const float each = 1.0F / static_cast<float>(filter.taps);
  for (int i = 0; i < filter.taps; ++i) {
    const float along = (static_cast<float>(i) + 0.5F) * each - 0.5F;
    const cv::Vec3f level = mesh.texture->sample(uv + along * filter.motion, filter.texture);
    for (int c = 0; c < 3; ++c) print[c] += linear_light_(level[c]);
  }
  const Light light = surface.instance == 0 ? still_.at(hit) : moving_.at(hit);
  const float lost = surface.instance == 0 ? pixel.lost : 0.0F;
  const float own = mesh.glow * (mesh.is_lamp ? pixel.lamps : 1.0F);
  constexpr float deepest = 0.2F;  // shadow: walls and ceiling send light into it
  for (int c = 0; c < 3; ++c) {
    const float lamps = std::max(light[c] - lost, deepest * light[c]);
    print[c] *= (pixel.lamps * lamps + light[3] + own) * each;
  }
  return print;
}

}  // namespace dkp_slam
