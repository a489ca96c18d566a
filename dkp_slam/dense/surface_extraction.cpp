#include "dkp_slam/dense/surface_extraction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <Eigen/Geometry>

namespace dkp_slam {
namespace {

using Grid = BlockGrid<Voxel>;
using Eigen::Vector3f;
using Eigen::Vector3i;

/// A surface that was seen at an angle changes the distance faster than a metre a metre.
constexpr float steepest = 2.5F;

/// What a voxel says at the end.
struct Sample {
  bool known = false;
  float distance = 0.0F;
  const Voxel* voxel = nullptr;
};

/// The eight corners of a cell, corner i at offset (i & 1, i >> 1 & 1, i >> 2 & 1).
struct Corners {
  std::array<Sample, 8> at;
};

constexpr std::array<std::array<int, 2>, 12> edges = {{{0, 1},
                                                       {2, 3},
                                                       {4, 5},
                                                       {6, 7},
                                                       {0, 2},
                                                       {1, 3},
                                                       {4, 6},
                                                       {5, 7},
                                                       {0, 4},
                                                       {1, 5},
                                                       {2, 6},
                                                       {3, 7}}};

Vector3i offset_of(int corner) { return {corner & 1, corner >> 1 & 1, corner >> 2 & 1}; }

class Extraction {
 public:
  Extraction(const DenseMap& map, const SurfaceOptions& options)
      : grid_(map.voxels()),
        size_(static_cast<float>(map.options().voxel)),
        free_(static_cast<float>(map.options().truncation)),
        least_views_(static_cast<float>(options.least_views)),
        moving_share_(static_cast<float>(options.moving_share)),
        vertex_of_(grid_.most()) {}

  SurfaceMesh run() {
    for (std::size_t b = 0; b < grid_.size(); ++b) make_vertices(b);
    for (std::size_t b = 0; b < grid_.size(); ++b) make_triangles(b);
    return std::move(mesh_);
  }

 private:
  /// Of one cell: its vertex in the mesh and one more, 0 for none.
  struct VertexIndex {
    int plus_one = 0;
  };

  Sample sample(const Voxel& voxel) const {
    if (voxel.seen_through > voxel.hits) {
      return {voxel.seen_through >= least_views_, free_, nullptr};
    }
    const bool still = voxel.moving < moving_share_ * voxel.hits || voxel.moving < least_views_;
    return {still && voxel.hits - voxel.seen_through >= least_views_, voxel.distance, &voxel};
  }

  /// Where the surface crosses an edge; false where it does not.
  bool crosses(const Sample& a, const Sample& b) const {
    if (!a.known || !b.known || (a.distance > 0.0F) == (b.distance > 0.0F)) return false;
    // Deep behind a surface the other side was not seen: no surface is there.
    return std::min(a.distance, b.distance) > -steepest * size_;
  }

  Corners corners_of(std::size_t block, const Vector3i& cell) const;
  void make_vertices(std::size_t block);
  void make_vertex(const Vector3i& cell, const Corners& corners);
  void make_triangles(std::size_t block);
  void make_quad(const Vector3i& cell, int axis, bool outwards);
  int vertex_at(const Vector3i& cell) const {
    const VertexIndex* found = vertex_of_.cell(cell);
    return found ? found->plus_one - 1 : -1;
  }

  const Grid& grid_;
  float size_, free_, least_views_, moving_share_;
  BlockGrid<VertexIndex> vertex_of_;
  SurfaceMesh mesh_;
};

Corners Extraction::corners_of(std::size_t block, const Vector3i& cell) const {
  Corners corners;
  const Vector3i place = grid_.place(block);
  for (int i = 0; i < 8; ++i) {
    const Vector3i at = cell + offset_of(i);
    const bool inside = Grid::block_of(at) == place;
    const Voxel* voxel = inside ? &grid_.block(block)[Grid::index_in_block(at)] : grid_.cell(at);
    if (voxel) corners.at[static_cast<std::size_t>(i)] = sample(*voxel);
  }
  return corners;
}

void Extraction::make_vertices(std::size_t block) {
  const Vector3i first = grid_.place(block) * Grid::side;
  for (int i = 0; i < Grid::cells; ++i) {
    const Vector3i cell = first + Vector3i(i & 7, i >> 3 & 7, i >> 6);
    make_vertex(cell, corners_of(block, cell));
  }
}

void Extraction::make_vertex(const Vector3i& cell, const Corners& corners) {
  Vector3f sum = Vector3f::Zero(), normal = Vector3f::Zero(), colour = Vector3f::Zero();
  float crossings = 0.0F, colours = 0.0F;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [i, j] = edges[e];
    const Sample& a = corners.at[static_cast<std::size_t>(i)];
    const Sample& b = corners.at[static_cast<std::size_t>(j)];
    if (a.known && b.known) normal[static_cast<int>(e / 4)] += b.distance - a.distance;
    if (!crosses(a, b)) continue;
    const float share = a.distance / (a.distance - b.distance);
    sum += offset_of(i).cast<float>() + share * (offset_of(j) - offset_of(i)).cast<float>();
    crossings += 1.0F;
  }
  if (crossings < 3.0F) return;
  for (const Sample& s : corners.at) {
    if (!s.voxel || s.voxel->colours == 0) continue;
    const float near = 1.0F / (std::abs(s.distance) + 0.1F * size_);
    const std::uint16_t* bgr = s.voxel->colour;
    colour += near * Vector3f(bgr[2], bgr[1], bgr[0]);
    colours += near;
  }
  vertex_of_.add(Grid::block_of(cell));
  (*vertex_of_.find(Grid::block_of(cell)))[Grid::index_in_block(cell)].plus_one =
      static_cast<int>(mesh_.vertices.size()) + 1;
  mesh_.vertices.emplace_back((cell.cast<float>() + sum / crossings) * size_);
  mesh_.normals.push_back(normal.stableNormalized());
  if (colours > 0.0F) colour /= 256.0F * colours;
  std::array<std::uint8_t, 3> rgb{};
  for (int c = 0; c < 3; ++c) {
    rgb[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::lround(colour[c]));
  }
  mesh_.colours.push_back(rgb);
}

void Extraction::make_triangles(std::size_t block) {
  const Vector3i first = grid_.place(block) * Grid::side;
  for (int i = 0; i < Grid::cells; ++i) {
    const Vector3i cell = first + Vector3i(i & 7, i >> 3 & 7, i >> 6);
    const Sample a = sample(grid_.block(block)[static_cast<std::size_t>(i)]);
    if (!a.known) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const Voxel* next = grid_.cell(cell + Vector3i::Unit(axis));
      if (!next) continue;
      const Sample b = sample(*next);
      if (crosses(a, b)) make_quad(cell, axis, b.distance > a.distance);
    }
  }
}

/// Of the four cells around an edge that begins at a voxel. `outwards`: free space is ahead.
void Extraction::make_quad(const Vector3i& cell, int axis, bool outwards) {
  const Vector3i u = Vector3i::Unit((axis + 1) % 3), v = Vector3i::Unit((axis + 2) % 3);
  std::array<int, 4> corner = {vertex_at(cell - u - v), vertex_at(cell - v), vertex_at(cell),
                               vertex_at(cell - u)};
  if (*std::min_element(corner.begin(), corner.end()) < 0) return;
  if (!outwards) std::swap(corner[1], corner[3]);
  const auto length = [&](int a, int b) {
    const auto& at = mesh_.vertices;
    return (at[static_cast<std::size_t>(corner[static_cast<std::size_t>(a)])] -
            at[static_cast<std::size_t>(corner[static_cast<std::size_t>(b)])])
        .squaredNorm();
  };
  // Along the shorter diagonal.
  if (length(0, 2) <= length(1, 3)) {
    mesh_.triangles.push_back({corner[0], corner[1], corner[2]});
    mesh_.triangles.push_back({corner[0], corner[2], corner[3]});
  } else {
    mesh_.triangles.push_back({corner[0], corner[1], corner[3]});
    mesh_.triangles.push_back({corner[1], corner[2], corner[3]});
  }
}

/// Pieces that hang together, by path halving.
class Pieces {
 public:
  explicit Pieces(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parent_;
};

double area_of(const SurfaceMesh& mesh, const std::array<int, 3>& t) {
  const auto at = [&](int i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
  return 0.5 * static_cast<double>((at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).norm());
}

/// Without the small pieces, and without vertices that belong to no triangle.
SurfaceMesh without_islands(const SurfaceMesh& mesh, double least_area) {
  Pieces pieces(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    pieces.join(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]));
    pieces.join(static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2]));
  }
  std::vector<double> area(mesh.vertices.size(), 0.0);
  for (const auto& t : mesh.triangles) {
    area[pieces.find(static_cast<std::size_t>(t[0]))] += area_of(mesh, t);
  }
  SurfaceMesh kept;
  std::vector<int> index(mesh.vertices.size(), -1);
  for (const auto& t : mesh.triangles) {
    if (area[pieces.find(static_cast<std::size_t>(t[0]))] < least_area) continue;
    std::array<int, 3> renamed{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto old = static_cast<std::size_t>(t[i]);
      if (index[old] < 0) {
        index[old] = static_cast<int>(kept.vertices.size());
        kept.vertices.push_back(mesh.vertices[old]);
        kept.normals.push_back(mesh.normals[old]);
        kept.colours.push_back(mesh.colours[old]);
      }
      renamed[i] = index[old];
    }
    kept.triangles.push_back(renamed);
  }
  return kept;
}

}  // namespace

SurfaceMesh extract_surface(const DenseMap& map, const SurfaceOptions& options) {
  return without_islands(Extraction(map, options).run(), options.least_area);
}

}  // namespace dkp_slam
