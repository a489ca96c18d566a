#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "dkp_slam/synth/room/furniture_kit.h"
#include "dkp_slam/synth/room/prints.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

/// An upright book or binder: its spine in front, `left` its left edge.
void add_book(FurnitureKit* kit, double left, const Vector3d& size, double depth,
              const Material& cover, const cv::Mat& spine) {
  const double x = left + 0.5 * size.x();
  const double y = -0.5 * depth + 0.5 * size.y() + kit->rng.uniform(0.0, 0.03);
  kit->block({x, y, 0.5 * size.z()}, size, cover);
  kit->picture({x - 0.5 * size.x(), y - 0.5 * size.y() - 5e-4, size.z()}, {size.x(), 0, 0},
               {0, 0, -size.z()}, make_texture(spine));
}

}  // namespace

std::vector<Mesh> book_row(cv::RNG& rng, double width, double height, double depth) {
  FurnitureKit kit(rng);
  const Material covers[3] = {kit.smooth(room_colour(rng)), kit.smooth(room_colour(rng)),
                              kit.smooth({205, 215, 220})};
  const double end = 0.5 * width - 0.01;
  double x = -0.5 * width + 0.01;
  const bool binders = rng.uniform(0, 4) == 0;
  const double stop = rng.uniform(0, 3) == 0 ? rng.uniform(0.2, 0.7) * end : end;
  while (x < stop) {
    const double thick = binders ? 0.07 : rng.uniform(0.014, 0.048);
    const double tall = binders ? std::min(0.30, height - 0.02) : height * rng.uniform(0.58, 0.90);
    const double deep = binders ? depth * 0.95 : depth * rng.uniform(0.6, 0.85);
    if (x + thick > end) break;
    const cv::Size texels(std::max(cvRound(thick * 800.0), 10), cvRound(tall * 500.0));
    const cv::Mat spine = binders ? binder_spine_print(rng, texels) : book_spine_print(rng, texels);
    add_book(&kit, x, {thick, deep, tall}, depth, covers[rng.uniform(0, 3)], spine);
    x += thick + 0.0015;
  }
  if (end - x > 0.22) {  // what stands beside the books
    const Vector3d foot(0.5 * (x + end), -0.02, 0.0);
    const int kind = rng.uniform(0, 3);
    if (kind == 0) {
      kit.turned(foot, {{0.03, 0.2}, {0.035, 0.16}, {0.07, 0.1}, {0.06, 0.02}, {0.0, 0.0}}, 20,
                 {make_texture(rug_print(rng, {256, 128})), 1.0});
    } else if (kind == 1) {
      kit.block(foot + Vector3d(0, 0, 0.08), {0.2, 0.16, 0.16},
                {make_texture(cardboard_print(rng, {128, 128})), 0.2}, rng.uniform(-0.3, 0.3));
    } else {
      kit.block(foot + Vector3d(0, 0, 0.10), {0.16, 0.012, 0.2}, covers[0]);
      kit.picture(foot + Vector3d(-0.07, -0.007, 0.19), {0.14, 0, 0}, {0, 0, -0.18},
                  make_texture(landscape_print(rng, {112, 144})));
    }
  }
  return kit.meshes;
}

std::vector<Mesh> keyboard_and_mouse(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material plastic = kit.smooth({48, 46, 46});
  kit.block({0, 0, 0.009}, {0.44, 0.14, 0.018}, plastic);
  kit.picture({-0.215, 0.065, 0.0185}, {0.43, 0, 0}, {0, -0.13, 0},
              make_texture(keyboard_print(rng, {430, 130})));
  kit.picture({0.27, 0.10, 0.002}, {0.24, 0, 0}, {0, -0.20, 0},
              make_texture(any_poster_print(rng, {144, 120})));  // mouse pad
  kit.add(standing({0.38, 0.0, 0.02}, 0.2) *
          ellipsoid_mesh({0.03, 0.055, 0.018}, 16, plastic.texture));
  return kit.meshes;
}

std::vector<Mesh> mug(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material print = {make_texture(any_poster_print(rng, {256, 96})), 1.0};
  kit.turned({0, 0, 0}, {{0.036, 0.095}, {0.041, 0.097}, {0.041, 0.09}, {0.040, 0.004}, {0.0, 0.0}},
             24, print);
  kit.turned({0, 0, 0.07}, {{0.0, 0.001}, {0.036, 0.0}}, 20, kit.smooth({25, 40, 60}));
  kit.block({0.052, 0, 0.05}, {0.022, 0.01, 0.05}, print);
  return kit.meshes;
}

std::vector<Mesh> desk_lamp(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material metal = kit.smooth(room_colour(rng, 30, 150));
  kit.turned({0, 0, 0}, {{0.0, 0.025}, {0.08, 0.022}, {0.09, 0.0}}, 24, metal);
  kit.turned({0, 0, 0.02}, {{0.008, 0.42}, {0.008, 0.0}}, 8, metal);
  kit.block({0.0, -0.10, 0.44}, {0.014, 0.22, 0.014}, metal);
  kit.turned({0, -0.2, 0.36}, {{0.02, 0.10}, {0.035, 0.08}, {0.085, 0.0}}, 24, metal);
  return kit.meshes;
}

std::vector<Mesh> stack_of_papers(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const int sheets = rng.uniform(2, 6);
  for (int i = 0; i < sheets; ++i) {
    FurnitureKit sheet(rng);
    const double z = 0.003 * (i + 1);
    sheet.picture({-0.105, 0.1485, z}, {0.21, 0, 0}, {0, -0.297, 0},
                  make_texture(page_print(rng, {168, 238})));
    const double yaw = rng.uniform(-0.6, 0.6), x = rng.uniform(-0.07, 0.07);
    kit.place(sheet.meshes, {x, rng.uniform(-0.04, 0.04), 0.0}, yaw);
  }
  return kit.meshes;
}

std::vector<Mesh> waste_bin(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material metal = kit.smooth({58, 62, 66});
  kit.turned({0, 0, 0}, {{0.135, 0.33}, {0.145, 0.34}, {0.145, 0.32}, {0.115, 0.005}, {0.0, 0.005}},
             24, metal);
  for (int i = 0; i < 4; ++i) {  // crumpled paper
    const double x = rng.uniform(-0.06, 0.06), y = rng.uniform(-0.06, 0.06);
    const TexturePtr print = make_texture(page_print(rng, {64, 64}));
    kit.add(standing({x, y, 0.25 + 0.02 * i}, rng.uniform(0.0, 6.0)) *
            ellipsoid_mesh({0.05, 0.04, 0.045}, 7, print));
  }
  return kit.meshes;
}

std::vector<Mesh> cupboard(cv::RNG& rng, const Vector3d& size, const cv::Scalar& colour,
                           int columns, int rows) {
  FurnitureKit kit(rng);
  kit.block({0, 0, 0.5 * size.z()}, size, kit.wood(colour));
  constexpr double texels = 320.0;
  const cv::Size pixels(cvRound(size.x() * texels), cvRound(size.z() * texels));
  kit.picture({-0.5 * size.x(), -0.5 * size.y() - 0.001, size.z()}, {size.x(), 0, 0},
              {0, 0, -size.z()},
              make_texture(cabinet_front_print(rng, pixels, colour, columns, rows)));
  return kit.meshes;
}

std::vector<Mesh> table(cv::RNG& rng, double width, double depth, double height) {
  FurnitureKit kit(rng);
  const Material wood = kit.wood(cv::Scalar(80, 120, 158) * rng.uniform(0.7, 1.25));
  kit.block({0, 0, height - 0.015}, {width, depth, 0.03}, wood);
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      kit.block({x * (width - 0.12), y * (depth - 0.12), 0.5 * (height - 0.03)},
                {0.06, 0.06, height - 0.03}, wood);
    }
  }
  return kit.meshes;
}

std::vector<Mesh> plain_chair(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material wood = kit.wood(cv::Scalar(70, 105, 140) * rng.uniform(0.7, 1.3));
  const Material seat = kit.cloth(room_colour(rng, 60, 170));
  for (const double x : {-0.19, 0.19}) {
    kit.block({x, -0.18, 0.21}, {0.035, 0.035, 0.42}, wood);
    kit.block({x, 0.19, 0.45}, {0.035, 0.035, 0.90}, wood);
  }
  kit.cushion({0, 0, 0.435}, {0.43, 0.43, 0.05}, 0.02, seat);
  for (const double z : {0.60, 0.73, 0.86}) kit.block({0, 0.19, z}, {0.34, 0.02, 0.06}, wood);
  return kit.meshes;
}

std::vector<Mesh> floor_lamp(cv::RNG& rng) {
  FurnitureKit kit(rng);
  const Material metal = kit.smooth({60, 60, 62}), shade = kit.cloth({150, 190, 215});
  kit.turned({0, 0, 0}, {{0.0, 0.03}, {0.14, 0.025}, {0.15, 0.0}}, 24, metal);
  kit.turned({0, 0, 0.02}, {{0.012, 1.4}, {0.012, 0.0}}, 10, metal);
  kit.turned({0, 0, 1.35}, {{0.12, 0.30}, {0.22, 0.0}}, 28, shade);
  return kit.meshes;
}

}  // namespace dkp_slam
