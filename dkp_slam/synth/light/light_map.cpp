#include "dkp_slam/synth/light/light_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/core/utility.hpp>

#include "dkp_slam/synth/mesh/texture.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3f;

constexpr float lamp_half_side = 0.3F;  // metres
// A surface 1.9 m under one of four lamps in an office gets about 1 in all.
constexpr float lamp_power = 2.1F;  // metres squared
constexpr float lamp_reach = 6.0F;  // metres; farther ones give less than 3%
constexpr float lift = 2e-3F;       // metres from a surface to the start of its shadow rays
constexpr float grid = 0.08F;       // metres between light points
constexpr int most_steps = 48;      // of light points along a triangle's edge
constexpr float to_middle = 0.01F;  // share by which points keep off their triangle's edges
constexpr int gather_rays = 64;
constexpr float open_distance = 1.0F;  // metres: nothing nearer than this keeps that light off

Vector3f interpolate(const std::vector<Vector3f>& of, const Eigen::Vector3i& t, float u, float v) {
  const auto at = [&](int i) -> const Vector3f& { return of[static_cast<std::size_t>(t[i])]; };
  return (1.0F - u - v) * at(0) + u * at(1) + v * at(2);
}

/// `count` directions around +z whose density follows the cosine, along a spiral.
std::vector<Vector3f> half_space(int count) {
  std::vector<Vector3f> directions;
  for (int i = 0; i < count; ++i) {
    const double r2 = (i + 0.5) / count;
    const double angle = 2.0 * std::numbers::pi * std::numbers::phi * i;
    directions.emplace_back(Eigen::Vector3d(std::sqrt(r2) * std::cos(angle),
                                            std::sqrt(r2) * std::sin(angle), std::sqrt(1.0 - r2))
                                .cast<float>());
  }
  return directions;
}

int light_index(int steps, int i, int j) { return j * (steps + 1) - j * (j - 1) / 2 + i; }

}  // namespace

Light plain_light() {
  Light light;
  light << Eigen::Vector3f::Constant(1.0F - without_lamps), without_lamps;
  return light;
}

Lamps::Lamps(const std::vector<Eigen::Vector3d>& places) {
  for (const Eigen::Vector3d& place : places) places_.push_back(place.cast<float>());
}

float Lamps::strength(int lamp, const Vector3f& point, const Vector3f& normal) const {
  const Vector3f to = place(lamp) - point;
  const float distance2 = to.squaredNorm();
  if (distance2 > lamp_reach * lamp_reach) return 0.0F;
  const float down = to.z(), facing = normal.dot(to);
  if (down <= 0.0F || facing <= 0.0F) return 0.0F;
  // Both cosines and the square of the distance, which is never nearer than the panel's size.
  return lamp_power * facing * down / (distance2 * (distance2 + lamp_half_side * lamp_half_side));
}

Ray Lamps::towards(int lamp, const Vector3f& point, float a, float b) const {
  const Vector3f at = place(lamp) + Vector3f(a * lamp_half_side, b * lamp_half_side, 0.0F);
  constexpr float almost = 0.98F;  // what hangs the lamp up does not shade it
  return {point, at - point, almost};
}

LightMap::LightMap(const EmbreeScene& scene, const Lamps& lamps) : scene_(scene) {
  for (int s = 0; s < scene.still_surfaces(); ++s) {
    const cv::Vec3f mean = scene.surface(s).mesh->texture->mean();
    Light albedo;
    for (int c = 0; c < 3; ++c) albedo[c] = linear_light(mean[c]);
    albedo[3] = (albedo[0] + albedo[1] + albedo[2]) / 3.0F;
    albedos_.push_back(albedo);
  }
  std::vector<Point> points;
  lay_out(&points);
  if (lamps.none()) {
    lights_.assign(points.size(), plain_light());
    return;
  }
  shine(lamps, points);
  bounce(points);
}

void LightMap::lay_out(std::vector<Point>* points) {
  for (int s = 0; s < scene_.still_surfaces(); ++s) {
    const Mesh& mesh = *scene_.surface(s).mesh;
    first_patch_.push_back(static_cast<int>(patches_.size()));
    int vertices_at = -1;
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const auto corner = [&](int i) -> const Vector3f& {
        return mesh.rest.vertices[static_cast<std::size_t>(t[i])];
      };
      const Vector3f a = corner(1) - corner(0), b = corner(2) - corner(0);
      const float longest = std::max({a.norm(), b.norm(), (a - b).norm()});
      const float size = std::max(std::sqrt(a.cross(b).norm()), 0.25F * longest);
      const int steps = std::min(static_cast<int>(std::lround(size / grid)), most_steps);
      if (steps < 2) {
        if (vertices_at < 0) {
          vertices_at = static_cast<int>(points->size());
          for (std::size_t i = 0; i < mesh.rest.vertices.size(); ++i) {
            points->push_back({mesh.rest.vertices[i], mesh.rest.normals[i]});
          }
        }
        patches_.push_back({vertices_at, 0});
        continue;
      }
      patches_.push_back({static_cast<int>(points->size()), steps});
      for (int j = 0; j <= steps; ++j) {
        for (int i = 0; i + j <= steps; ++i) {
          // A little off the edges: there, in a corner, a neighbour begins.
          const auto inwards = [&](int k) {
            return (1.0F - to_middle) * static_cast<float>(k) / static_cast<float>(steps) +
                   to_middle / 3.0F;
          };
          const float u = inwards(i), v = inwards(j);
          points->push_back({interpolate(mesh.rest.vertices, t, u, v),
                             interpolate(mesh.rest.normals, t, u, v).normalized()});
        }
      }
    }
  }
}

void LightMap::shine(const Lamps& lamps, const std::vector<Point>& points) {
  lights_.assign(points.size(), Light::Zero());
  constexpr int side = 4;  // of the grid of rays to a lamp
  const auto light = [&](const Point& point) {
    const Vector3f from = point.position + lift * point.normal;
    float sum = 0.0F;
    for (int lamp = 0; lamp < lamps.count(); ++lamp) {
      const float strength = lamps.strength(lamp, point.position, point.normal);
      if (strength <= 0.0F) continue;
      int open = 0;
      for (int half = 0; half < side * side; half += packet_size) {
        Rays rays;
        for (int i = 0; i < packet_size; ++i) {
          const auto place = [&](int k) {
            return (static_cast<float>(k) + 0.5F) * 2.0F / side - 1.0F;
          };
          rays[static_cast<std::size_t>(i)] =
              lamps.towards(lamp, from, place((half + i) % side), place((half + i) / side));
        }
        const unsigned bits = scene_.blocked(rays, packet_size, {});
        for (int i = 0; i < packet_size; ++i) open += (bits >> i & 1U) == 0 ? 1 : 0;
      }
      sum += strength * static_cast<float>(open) / (side * side);
    }
    return sum;
  };
  cv::parallel_for_({0, static_cast<int>(points.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const auto k = static_cast<std::size_t>(i);
      lights_[k].head<3>().setConstant(light(points[k]));
    }
  });
}

void LightMap::bounce(const std::vector<Point>& points) {
  std::vector<Light> gathered(points.size());
  cv::parallel_for_({0, static_cast<int>(points.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const auto k = static_cast<std::size_t>(i);
      gathered[k] = gather(points[k]);
    }
  });
  for (std::size_t k = 0; k < points.size(); ++k) lights_[k] += gathered[k];
}

Light LightMap::gather(const Point& point) const {
  static const std::vector<Vector3f> pattern = half_space(gather_rays);
  const Vector3f& n = point.normal;
  const Vector3f side =
      (std::abs(n.z()) < 0.9F ? Vector3f(Vector3f::UnitZ()) : Vector3f(Vector3f::UnitX()))
          .cross(n)
          .normalized();
  const Vector3f up = n.cross(side);
  Light sum = Light::Zero();
  for (int first = 0; first < gather_rays; first += packet_size) {
    Rays rays;
    for (int i = 0; i < packet_size; ++i) {
      const Vector3f& d = pattern[static_cast<std::size_t>(first + i)];
      rays[static_cast<std::size_t>(i)] = {point.position + lift * n,
                                           d.x() * side + d.y() * up + d.z() * n};
    }
    const SurfaceHits hits = scene_.trace(rays, packet_size, {}, false);
    for (const SurfaceHit& hit : hits) {
      const float open = hit.surface < 0 ? 1.0F : std::min(hit.distance / open_distance, 1.0F);
      sum[3] += without_lamps * open;
      if (hit.surface >= 0) sum += more_bounces * reflected(hit);
    }
  }
  return sum / static_cast<float>(gather_rays);
}

Light LightMap::at(const SurfaceHit& hit) const {
  const auto light = [&](int i) -> const Light& { return lights_[static_cast<std::size_t>(i)]; };
  const int patch_index = first_patch_[static_cast<std::size_t>(hit.surface)] + hit.triangle;
  const Patch& patch = patches_[static_cast<std::size_t>(patch_index)];
  if (patch.steps == 0) {
    const Mesh& mesh = *scene_.surface(hit.surface).mesh;
    const Eigen::Vector3i& t = mesh.triangles[static_cast<std::size_t>(hit.triangle)];
    return (1.0F - hit.u - hit.v) * light(patch.first + t[0]) + hit.u * light(patch.first + t[1]) +
           hit.v * light(patch.first + t[2]);
  }
  const float x = hit.u * static_cast<float>(patch.steps);
  const float y = hit.v * static_cast<float>(patch.steps);
  const int i = std::clamp(static_cast<int>(x), 0, patch.steps - 1);
  const int j = std::clamp(static_cast<int>(y), 0, patch.steps - 1 - i);
  const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
  const auto grid_light = [&](int di, int dj) -> const Light& {
    return light(patch.first + light_index(patch.steps, i + di, j + dj));
  };
  if (a + b <= 1.0F || i + j + 1 >= patch.steps) {
    return (1.0F - a - b) * grid_light(0, 0) + a * grid_light(1, 0) + b * grid_light(0, 1);
  }
  return (a + b - 1.0F) * grid_light(1, 1) + (1.0F - b) * grid_light(1, 0) +
         (1.0F - a) * grid_light(0, 1);
}

Light LightMap::reflected(const SurfaceHit& hit) const {
  const auto s = static_cast<std::size_t>(hit.surface);
  const Mesh& mesh = *scene_.surface(hit.surface).mesh;
  Light sent = at(hit).cwiseProduct(albedos_[s]);
  // The lamps' own light is counted where they shine; screens and windows belong to the rest.
  if (!mesh.is_lamp) sent[3] += mesh.glow * albedos_[s][3];
  return sent;
}

}  // namespace dkp_slam
