#include "dkp_slam/synth/figure/figure_loft.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dkp_slam {
namespace {

/// Monotone cubic interpolation of one measure of the sections, whose `along` falls.
double interpolate(const std::vector<Section>& s, double Section::*measure, double along) {
  const auto at = [&](std::size_t i) { return s[i].*measure; };
  if (along >= s.front().along) return at(0);
  if (along <= s.back().along) return at(s.size() - 1);
  std::size_t i = 0;
  while (s[i + 1].along > along) ++i;
  const auto slope = [&](std::size_t k) {
    return (at(k + 1) - at(k)) / (s[k + 1].along - s[k].along);
  };
  const auto tangent = [&](std::size_t k) {
    if (k == 0) return slope(0);
    if (k + 1 == s.size()) return slope(k - 1);
    const double a = slope(k - 1), b = slope(k);
    return a * b <= 0.0 ? 0.0 : 2.0 * a * b / (a + b);
  };
  const double width = s[i + 1].along - s[i].along;
  const double t = (along - s[i].along) / width;
  const double t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * at(i) + (t3 - 2 * t2 + t) * width * tangent(i) +
         (3 * t2 - 2 * t3) * at(i + 1) + (t3 - t2) * width * tangent(i + 1);
}

}  // namespace

double smooth_step(double value, double from, double to) {
  const double t = std::clamp((value - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Section section_at(const std::vector<Section>& sections, double along) {
  Section result{};
  result.along = along;
  for (const auto measure :
       {&Section::side, &Section::front, &Section::back, &Section::square, &Section::shift}) {
    result.*measure = interpolate(sections, measure, along);
  }
  return result;
}

double loft_angle(double u, double frontal) {
  const double even = 2.0 * std::numbers::pi * (u - 0.5);
  return even - frontal * std::sin(even);
}

Eigen::Vector3d section_point(const Section& section, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), n = section.square;
  const double r = std::pow(std::pow(std::abs(c), n) + std::pow(std::abs(s), n), -1.0 / n);
  return {section.shift + r * c * (c > 0.0 ? section.front : section.back), r * s * section.side,
          section.along};
}

void add_grid_triangles(Mesh& mesh, int rows, int sides) {
  for (int r = 0; r + 1 < rows; ++r) {
    for (int s = 0; s < sides; ++s) {
      const int a = r * (sides + 1) + s, below = a + sides + 1;
      mesh.triangles.emplace_back(a, below, below + 1);
      mesh.triangles.emplace_back(a, below + 1, a + 1);
    }
  }
}

void compute_grid_normals(Mesh& mesh, int rows, int sides) {
  std::vector<Eigen::Vector3f>& normals = mesh.rest.normals;
  const std::vector<Eigen::Vector3f>& v = mesh.rest.vertices;
  const auto index = [&](int r, int s) { return static_cast<std::size_t>(r * (sides + 1) + s); };
  normals.assign(v.size(), Eigen::Vector3f::Zero());
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto i = t.cast<std::size_t>().eval();
    const Eigen::Vector3f area = (v[i.y()] - v[i.x()]).cross(v[i.z()] - v[i.x()]);
    for (const std::size_t k : i) normals[k] += area;
  }
  for (int r = 0; r < rows; ++r) {
    const Eigen::Vector3f seam = normals[index(r, 0)] + normals[index(r, sides)];
    normals[index(r, 0)] = normals[index(r, sides)] = seam;
    // A pole: all columns in one point.
    if ((v[index(r, 0)] - v[index(r, sides / 2)]).norm() < 1e-5F) {
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (int s = 0; s < sides; ++s) sum += normals[index(r, s)];
      for (int s = 0; s <= sides; ++s) normals[index(r, s)] = sum;
    }
  }
  for (Eigen::Vector3f& n : normals) {
    n = n.norm() > 1e-12F ? Eigen::Vector3f(n.normalized()) : Eigen::Vector3f::UnitZ();
  }
}

SkinnedMesh loft(const LoftShape& shape, const Se3& place,
                 const std::function<Influence(const Eigen::Vector3d&)>& influence,
                 const std::function<Eigen::Vector3d(double, const Eigen::Vector3d&)>& bump) {
  SkinnedMesh skin;
  const double top = shape.sections.front().along, bottom = shape.sections.back().along;
  for (int r = 0; r < shape.rows; ++r) {
    const double v = static_cast<double>(r) / (shape.rows - 1);
    const Section section = section_at(shape.sections, top + v * (bottom - top));
    for (int s = 0; s <= shape.sides; ++s) {
      const double u = static_cast<double>(s) / shape.sides;
      // The last column is the first one, to the last bit.
      const double angle = loft_angle(s == shape.sides ? 0.0 : u, shape.frontal);
      Eigen::Vector3d point = section_point(section, angle);
      if (bump) point = bump(angle, point);
      point = place * point;
      skin.mesh.rest.vertices.push_back(point.cast<float>());
      skin.mesh.uv.emplace_back(static_cast<float>(u), static_cast<float>(v));
      skin.influences.push_back(influence(point));
    }
  }
  add_grid_triangles(skin.mesh, shape.rows, shape.sides);
  compute_grid_normals(skin.mesh, shape.rows, shape.sides);
  return skin;
}

void append(const SkinnedMesh& part, SkinnedMesh& whole) {
  const auto first = static_cast<int>(whole.mesh.rest.vertices.size());
  const auto add = [](const auto& from, auto& to) {
    to.insert(to.end(), from.begin(), from.end());
  };
  add(part.mesh.rest.vertices, whole.mesh.rest.vertices);
  add(part.mesh.rest.normals, whole.mesh.rest.normals);
  add(part.mesh.uv, whole.mesh.uv);
  add(part.influences, whole.influences);
  for (const Eigen::Vector3i& t : part.mesh.triangles) {
    whole.mesh.triangles.push_back(t.array() + first);
  }
}

}  // namespace dkp_slam
