#include "dkp_slam/synth/room/furniture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "dkp_slam/synth/room/furniture_kit.h"
#include "dkp_slam/synth/room/prints.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const cv::Scalar dark_metal(62, 60, 60), light_metal(176, 178, 180);

// The drawer cabinet's measures, which its drawers share.
constexpr double cabinet_width = 0.42, cabinet_depth = 0.55, cabinet_height = 0.62;
constexpr double cabinet_wall = 0.02;
constexpr int drawers = 3;

/// A leaf: a strip that bends down, from `root` along `out` (not of unit length).
Mesh leaf(const Vector3d& root, const Vector3d& out, double width, const TexturePtr& print) {
  Mesh mesh;
  mesh.texture = print;
  constexpr int parts = 6;
  const Vector3d side = out.cross(Vector3d::UnitZ()).normalized();
  for (int i = 0; i <= parts; ++i) {
    const double t = static_cast<double>(i) / parts;
    const Vector3d spine = root + t * out - 0.9 * out.norm() * t * t * t * Vector3d::UnitZ();
    const double half = 0.5 * width * std::sin(std::numbers::pi * (0.12 + 0.86 * t));
    const Vector3d along = out - 2.7 * out.norm() * t * t * Vector3d::UnitZ();
    const Eigen::Vector3f normal = side.cross(along).normalized().cast<float>();
    for (const double s : {-1.0, 1.0}) {
      mesh.rest.vertices.emplace_back((spine + s * half * side).cast<float>());
      mesh.rest.normals.push_back(normal);
      mesh.uv.emplace_back(static_cast<float>(t), s < 0.0 ? 0.0F : 1.0F);
    }
    if (i == parts) break;
    const int k = 2 * i;
    mesh.triangles.emplace_back(k, k + 1, k + 3);
    mesh.triangles.emplace_back(k, k + 3, k + 2);
  }
  return mesh;
}

/// Five feet in a star, a gas lift.
void add_swivel_base(FurnitureKit* kit, const Material& metal) {
  constexpr double reach = 0.30;
  for (int i = 0; i < 5; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 5.0 + 0.3;
    const Vector3d out(std::cos(angle), std::sin(angle), 0.0);
    kit->block(0.5 * reach * out + Vector3d(0, 0, 0.085), {reach, 0.045, 0.03}, metal, angle);
    Mesh caster = ellipsoid_mesh({0.03, 0.03, 0.03}, 10, metal.texture);
    kit->add(standing(reach * out + Vector3d(0, 0, 0.0301), 0.0) * caster);
  }
  kit->turned({0, 0, 0.07}, {{0.0, 0.31}, {0.028, 0.31}, {0.028, 0.12}, {0.045, 0.1}, {0.05, 0.0}},
              12, metal);
}

}  // namespace

std::vector<Mesh> desk(cv::RNG& rng, double width, double depth) {
  FurnitureKit kit(rng);
  const Material top = kit.wood({112, 156, 190}), metal = kit.smooth(light_metal);
  constexpr double height = 0.74, board = 0.03, leg = 0.05;
  kit.block({0, 0, height - 0.5 * board}, {width, depth, board}, top);
  const double x = 0.5 * width - 0.08, y = 0.5 * depth - 0.08;
  const double under = height - board;
  for (const double side : {-1.0, 1.0}) {
    for (const double end : {-1.0, 1.0}) {
      kit.block({side * x, end * y, 0.5 * under}, {leg, leg, under}, metal);
    }
    kit.block({side * x, 0, under - 0.03}, {leg * 0.8, 2.0 * y - leg, 0.05}, metal);
  }
  kit.block({0, y, under - 0.2}, {2.0 * x - leg, 0.018, 0.34}, top);  // modesty panel
  return kit.meshes;
}

std::vector<Mesh> office_chair(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material fabric = kit.cloth(room_colour(rng, 35, 110));
  const Material plastic = kit.smooth({44, 42, 42});
  add_swivel_base(&kit, plastic);
  kit.block({0, 0.02, 0.375}, {0.24, 0.26, 0.03}, plastic);
  kit.cushion({0, 0, 0.425}, {0.50, 0.48, 0.08}, 0.035, fabric);
  kit.block({0, 0.245, 0.52}, {0.07, 0.02, 0.30}, plastic);
  kit.cushion({0, 0.235, 0.80}, {0.46, 0.07, 0.50}, 0.03, fabric);
  for (const double side : {-0.28, 0.28}) {
    kit.block({side, 0.05, 0.51}, {0.03, 0.05, 0.24}, plastic);
    kit.cushion({side, 0.02, 0.645}, {0.07, 0.26, 0.035}, 0.015, plastic);
  }
  return kit.meshes;
}

std::vector<Mesh> drawer_cabinet(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material body = kit.smooth({186, 190, 192});
  const double w = cabinet_width, d = cabinet_depth, h = cabinet_height, t = cabinet_wall;
  for (const double side : {-0.5, 0.5}) {
    kit.block({side * (w - t), 0, 0.5 * h}, {t, d, h}, body);
  }
  kit.block({0, 0, h - 0.5 * t}, {w - 2.0 * t, d, t}, body);
  kit.block({0, 0, 0.04}, {w - 2.0 * t, d, 0.06}, body);
  kit.block({0, 0.5 * (d - t), 0.5 * h}, {w - 2.0 * t, t, h - 2.0 * t - 0.1}, body);
  return kit.meshes;
}

std::vector<Mesh> cabinet_drawer(cv::RNG& rng, int index) {
  FurnitureKit kit(rng);
  const Material body = kit.smooth({150, 155, 158}), front = kit.smooth({168, 172, 175});
  const Material handle = kit.smooth(dark_metal);
  const double t = cabinet_wall, w = cabinet_width - 2.0 * t - 0.008, d = cabinet_depth - 2.0 * t;
  const double lowest = 0.075, pitch = (cabinet_height - t - lowest) / drawers;
  const double height = pitch - 0.008;
  const double z = lowest + pitch * (std::clamp(index, 0, drawers - 1) + 0.5);
  const double front_y = -0.5 * cabinet_depth - 0.001;
  kit.block({0, front_y + 0.5 * t, z}, {w, t, height}, front);
  const double inside = 0.7 * height, inside_z = z - 0.1 * height, middle = front_y + t + 0.5 * d;
  for (const double side : {-0.5, 0.5}) {
    kit.block({side * (w - 0.03), middle, inside_z}, {0.012, d - 0.02, inside}, body);
  }
  kit.block({0, middle, inside_z - 0.5 * inside}, {w - 0.05, d - 0.03, 0.01}, body);
  kit.block({0, front_y + t + d - 0.03, inside_z}, {w - 0.06, 0.012, inside}, body);
  // A handle, a label, and some papers inside.
  kit.block({0, front_y - 0.012, z + 0.02}, {0.14, 0.016, 0.014}, handle);
  kit.picture({-0.05, front_y - 0.002, z + 0.075}, {0.1, 0, 0}, {0, 0, -0.035},
              make_texture(page_print(rng, {96, 36})));
  kit.picture({-0.12, middle + 0.15, inside_z}, {0.21, 0, 0}, {0, -0.30, 0},
              make_texture(page_print(rng, {150, 212})));
  return kit.meshes;
}

std::vector<Mesh> book_shelf(cv::RNG& rng, double width, double height) {
  FurnitureKit kit(rng);
  const Material body = kit.wood({88, 128, 160});
  constexpr double depth = 0.30, board = 0.022, back = 0.008;
  for (const double side : {-0.5, 0.5}) {
    kit.block({side * (width - board), 0, 0.5 * height}, {board, depth, height}, body);
  }
  const double inner = width - 2.0 * board;
  kit.block({0, 0.5 * (depth - back), 0.5 * height}, {inner, back, height - 2.0 * board - 0.06},
            body);
  const int shelves = std::max(static_cast<int>(std::lround(height / 0.37)), 2);
  const double lowest = 0.06, pitch = (height - board - lowest) / shelves;
  for (int i = 0; i <= shelves; ++i) {
    const double z = lowest + pitch * i;
    kit.block({0, -0.5 * back, z + 0.5 * board}, {inner, depth - back, board}, body);
    if (i == shelves) break;
    const Vector3d foot(0, 0.0, z + board);
    kit.place(book_row(rng, inner, pitch - board, depth - 0.06), foot);
  }
  return kit.meshes;
}

std::vector<Mesh> monitor(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material plastic = kit.smooth({38, 36, 36});
  constexpr double width = 0.60, height = 0.36, middle = 0.34, thick = 0.035, rim = 0.012;
  kit.block({0, 0.03, 0.008}, {0.26, 0.20, 0.016}, plastic);
  kit.block({0, 0.045, 0.17}, {0.06, 0.03, 0.32}, plastic);
  kit.block({0, 0, middle}, {width, thick, height}, plastic);
  const cv::Size texels(640, 380);
  const cv::Mat print =
      rng.uniform(0, 2) == 0 ? editor_print(rng, texels) : browser_print(rng, texels);
  constexpr float screen_glow = 0.42F;
  kit.picture({-0.5 * width + rim, -0.5 * thick - 0.001, middle + 0.5 * height - rim},
              {width - 2.0 * rim, 0, 0}, {0, 0, -(height - 2.5 * rim)}, make_texture(print),
              screen_glow);
  return kit.meshes;
}

std::vector<Mesh> cardboard_box(cv::RNG& rng, const Vector3d& size) {
  FurnitureKit kit(rng);
  constexpr double texels = 420.0;  // per metre
  const Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  const Vector3d top(-0.5 * size.x(), -0.5 * size.y(), size.z());
  const auto side = [&](const Vector3d& corner, const Vector3d& right, const Vector3d& down) {
    const cv::Size pixels(std::max(cvRound(right.norm() * texels), 32),
                          std::max(cvRound(down.norm() * texels), 32));
    kit.picture(corner, right, down, make_texture(cardboard_print(rng, pixels)));
  };
  side(top, x, -z);
  side(top + x + y, -x, -z);
  side(top + x, y, -z);
  side(top + y, -y, -z);
  side(top + y, x, -y);
  side(top - z, x, y);
  return kit.meshes;
}

std::vector<Mesh> potted_plant(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material pot = kit.smooth(room_colour(rng, 70, 190)), earth = kit.smooth({35, 45, 60});
  kit.turned({0, 0, 0},
             {{0.13, 0.27}, {0.15, 0.28}, {0.15, 0.25}, {0.14, 0.24}, {0.10, 0.0}, {0.0, 0.0}}, 24,
             pot);
  kit.turned({0, 0, 0.25}, {{0.0, 0.01}, {0.135, 0.0}}, 20, earth);
  const TexturePtr print = make_texture(leaf_print(rng, {128, 48}));
  const TexturePtr other = make_texture(leaf_print(rng, {128, 48}));
  constexpr int leaves = 34;
  for (int i = 0; i < leaves; ++i) {
    const double angle = std::numbers::phi * 2.0 * std::numbers::pi * i;
    const double height = rng.uniform(0.28, 0.75), reach = rng.uniform(0.18, 0.32);
    const Vector3d away(std::cos(angle), std::sin(angle), 0.0);
    const Vector3d root = 0.03 * away + Vector3d(0, 0, height);
    const Vector3d out = reach * away + Vector3d(0, 0, rng.uniform(0.10, 0.30));
    kit.add(leaf(root, out, rng.uniform(0.06, 0.11), i % 2 == 0 ? print : other));
  }
  kit.turned({0, 0, 0.25}, {{0.008, 0.55}, {0.02, 0.0}}, 8, kit.wood({60, 85, 105}));
  return kit.meshes;
}

std::vector<Mesh> sofa(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material cover = kit.cloth(room_colour(rng, 60, 150));
  const Material feet = kit.wood({50, 70, 90});
  constexpr double width = 1.9, depth = 0.88;
  for (const double x : {-0.85, 0.85}) {
    for (const double y : {-0.36, 0.36}) kit.block({x, y, 0.05}, {0.06, 0.06, 0.1}, feet);
  }
  kit.cushion({0, 0, 0.2}, {width, depth, 0.2}, 0.03, cover);
  for (const double x : {-0.42, 0.42}) {
    kit.cushion({x, -0.08, 0.375}, {0.83, 0.70, 0.16}, 0.05, cover);
    kit.cushion({x, 0.28, 0.62}, {0.83, 0.20, 0.42}, 0.07, cover);
  }
  for (const double x : {-0.89, 0.89}) {
    kit.cushion({x, 0.0, 0.43}, {0.16, depth, 0.32}, 0.06, cover);
  }
  for (const double x : {-0.62, 0.55}) {  // two loose ones with a print
    const Material print = {make_texture(any_poster_print(rng, {192, 192})), 0.45};
    kit.cushion({x, 0.10, 0.66}, {0.42, 0.13, 0.40}, 0.06, print);
  }
  return kit.meshes;
}

}  // namespace dkp_slam
