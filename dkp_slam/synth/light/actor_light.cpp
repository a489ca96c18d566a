#include "dkp_slam/synth/light/actor_light.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include <opencv2/core/utility.hpp>

namespace dkp_slam {
namespace {

using Eigen::Vector3f;

constexpr int probes = 64;              // rays around an actor
constexpr float off_the_skin = 0.008F;  // metres: meshes of clothes reach into each other
constexpr float off_the_wall = 0.004F;

/// Directions spread evenly over the sphere, along a spiral.
Vector3f spiral(int i) {
  const float z = 1.0F - 2.0F * (static_cast<float>(i) + 0.5F) / probes;
  const float r = std::sqrt(1.0F - z * z);
  const double angle = 2.0 * std::numbers::pi * std::numbers::phi * i;
  return {r * static_cast<float>(std::cos(angle)), r * static_cast<float>(std::sin(angle)), z};
}

/// Corners of the triangles that face the eye, or almost do.
std::vector<int> facing_vertices(const Surface& surface, const Vector3f& eye) {
  constexpr float almost = 0.1F;  // cosine: while it passes the camera a limb turns by less
  const auto& positions = surface.middle.vertices;
  const auto& normals = surface.middle.normals;
  std::vector<bool> faces(positions.size(), false);
  for (const Eigen::Vector3i& t : surface.mesh->triangles) {
    const auto corner = [&](const auto& of, int i) -> const auto& {
      return of[static_cast<std::size_t>(t[i])];
    };
    const Vector3f& a = corner(positions, 0);
    Vector3f cross = (corner(positions, 1) - a).cross(corner(positions, 2) - a);
    // Which side is outside only the normals say.
    if (cross.dot(corner(normals, 0)) < 0.0F) cross = -cross;
    const Vector3f view = eye - a;
    const float along = cross.dot(view);
    if (along < 0.0F &&
        along * along > almost * almost * cross.squaredNorm() * view.squaredNorm()) {
      continue;
    }
    for (int i = 0; i < 3; ++i) faces[static_cast<std::size_t>(t[i])] = true;
  }
  std::vector<int> vertices;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i]) vertices.push_back(static_cast<int>(i));
  }
  return vertices;
}

}  // namespace

ActorLight::ActorLight(const EmbreeScene& scene, const Lamps& lamps, const LightMap& map,
                       const Vector3f& eye)
    : scene_(scene), map_(map) {
  int last = 0;
  Cube cube;
  for (int s = scene.still_surfaces(); s < scene.surfaces(); ++s) {
    const Surface& surface = scene.surface(s);
    if (lamps.none()) {
      vertices_.emplace_back(surface.middle.vertices.size(), plain_light());
      continue;
    }
    if (surface.instance != last) cube = around(surface.instance);
    last = surface.instance;
    vertices_.emplace_back(surface.middle.vertices.size(), Light::Zero());
    shine(lamps, surface, cube, facing_vertices(surface, eye), &vertices_.back());
  }
}

ActorLight::Cube ActorLight::around(int instance) const {
  Vector3f lowest = Vector3f::Constant(1e9F), highest = -lowest;
  for (int s = scene_.still_surfaces(); s < scene_.surfaces(); ++s) {
    if (scene_.surface(s).instance != instance) continue;
    for (const Vector3f& v : scene_.surface(s).middle.vertices) {
      lowest = lowest.cwiseMin(v);
      highest = highest.cwiseMax(v);
    }
  }
  const Vector3f centre = 0.5F * (lowest + highest);
  Cube cube;
  cube.fill(Light::Zero());
  for (int first = 0; first < probes; first += packet_size) {
    Rays rays;
    for (int i = 0; i < packet_size; ++i) {
      rays[static_cast<std::size_t>(i)] = {centre, spiral(first + i)};
    }
    const SurfaceHits hits = scene_.trace(rays, packet_size, {});
    for (std::size_t i = 0; i < packet_size; ++i) {
      Light from(0.0F, 0.0F, 0.0F, without_lamps);
      if (hits[i].surface >= 0) from += more_bounces * map_.reflected(hits[i]);
      for (int axis = 0; axis < 6; ++axis) {
        const float along = rays[i].direction[axis / 2] * (axis % 2 == 0 ? 1.0F : -1.0F);
        // The cosine's integral over the half space is pi, of the sphere's 4 pi.
        cube[static_cast<std::size_t>(axis)] += std::max(along, 0.0F) * 4.0F / probes * from;
      }
    }
  }
  return cube;
}

void ActorLight::shine(const Lamps& lamps, const Surface& surface, const Cube& cube,
                       const std::vector<int>& vertices, std::vector<Light>* lights) const {
  const auto& positions = surface.middle.vertices;
  const auto& normals = surface.middle.normals;
  for (std::size_t k = 0; k < normals.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      const float n = normals[k][axis];
      (*lights)[k] += n * n * cube[static_cast<std::size_t>(2 * axis + (n < 0.0F ? 1 : 0))];
    }
  }
  const auto light_packet = [&](std::size_t first) {
    const std::size_t lanes = std::min<std::size_t>(packet_size, vertices.size() - first);
    const auto vertex = [&](std::size_t i) {
      return static_cast<std::size_t>(vertices[first + i]);
    };
    for (int lamp = 0; lamp < lamps.count(); ++lamp) {
      Rays rays;
      std::array<float, packet_size> strength{};
      for (std::size_t i = 0; i < lanes; ++i) {
        const std::size_t k = vertex(i);
        strength[i] = lamps.strength(lamp, positions[k], normals[k]);
        rays[i] = lamps.towards(lamp, positions[k] + off_the_skin * normals[k], 0.0F, 0.0F);
      }
      if (std::all_of(strength.begin(), strength.end(), [](float s) { return s <= 0.0F; })) {
        continue;
      }
      const unsigned bits =
          scene_.blocked(rays, static_cast<int>(lanes), {.moment = scene_.middle()});
      for (std::size_t i = 0; i < lanes; ++i) {
        if ((bits >> i & 1U) == 0) (*lights)[vertex(i)].head<3>().array() += strength[i];
      }
    }
  };
  const auto packets = static_cast<int>((vertices.size() + packet_size - 1) / packet_size);
  cv::parallel_for_({0, packets}, [&](const cv::Range& range) {
    for (int p = range.start; p < range.end; ++p) {
      light_packet(static_cast<std::size_t>(p) * packet_size);
    }
  });
}

Light ActorLight::at(const SurfaceHit& hit) const {
  const auto& lights = vertices_[static_cast<std::size_t>(hit.surface - scene_.still_surfaces())];
  const Eigen::Vector3i& t =
      scene_.surface(hit.surface).mesh->triangles[static_cast<std::size_t>(hit.triangle)];
  const auto at = [&](int i) -> const Light& { return lights[static_cast<std::size_t>(t[i])]; };
  return (1.0F - hit.u - hit.v) * at(0) + hit.u * at(1) + hit.v * at(2);
}

float light_lost_to_actors(const EmbreeScene& scene, const Lamps& lamps, const Vector3f& point,
                           const Vector3f& normal) {
  // Eight places on a lamp, one in each column and row of a grid (eight rooks).
  constexpr int count = 8;
  constexpr float places[count][2] = {{-0.875F, -0.125F}, {-0.625F, 0.625F}, {-0.375F, -0.625F},
                                      {-0.125F, 0.125F},  {0.125F, 0.875F},  {0.375F, -0.375F},
                                      {0.625F, 0.375F},   {0.875F, -0.875F}};
  const Vector3f from = point + off_the_wall * normal;
  const int middle = scene.middle();
  Rays rays;
  std::array<float, packet_size / count> strengths{};
  int waiting = 0;
  float lost = 0.0F;
  const auto trace = [&] {
    unsigned shaded = scene.blocked(rays, waiting * count, {.still = false, .moment = middle});
    // What furniture keeps away already, actors cannot keep away again.
    if (shaded != 0) shaded &= ~scene.blocked(rays, waiting * count, {});
    for (int i = 0; i < waiting; ++i) {
      const unsigned of_lamp = shaded >> (i * count) & ((1U << count) - 1U);
      lost += strengths[static_cast<std::size_t>(i)] * static_cast<float>(std::popcount(of_lamp)) /
              count;
    }
    waiting = 0;
  };
  for (int lamp = 0; lamp < lamps.count(); ++lamp) {
    const float strength = lamps.strength(lamp, point, normal);
    if (strength <= 0.0F) continue;
    for (int i = 0; i < count; ++i) {
      rays[static_cast<std::size_t>(waiting * count + i)] =
          lamps.towards(lamp, from, places[i][0], places[i][1]);
    }
    strengths[static_cast<std::size_t>(waiting)] = strength;
    if (++waiting == packet_size / count) trace();
  }
  if (waiting > 0) trace();
  return lost;
}

}  // namespace dkp_slam
