#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/synth/room/furniture.h"
#include "dkp_slam/synth/room/prints.h"
#include "dkp_slam/synth/room/room_parts.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

// The office lies at the origin; the other rooms around it, walls 0.1 m thick.
const RoomShape corridor = {2.8, 4.2, -2.4, 3.3};
const RoomShape living_room = {2.8, 8.0, 3.4, 7.8};
const RoomShape kitchen = {-2.7, 2.7, 3.4, 7.5};
// Doorways as seen from these rooms; those of the office are in its own plan.
const Opening corridor_to_office = doorway(0.5), corridor_to_living = doorway(0.25);
const Opening living_to_corridor = doorway(4.05), living_to_kitchen = doorway(2.5);
const Opening kitchen_to_living = doorway(0.7), kitchen_to_office = doorway(0.1);

cv::Size texels(double width, double height) {
  constexpr double metre = 420.0;
  return {cvRound(width * metre), cvRound(height * metre)};
}

cv::Mat plaster(FurnitureKit* kit, const Wall& wall, const cv::Scalar& colour) {
  return plaster_print(kit->rng, wall_texels(wall.length, wall.height), colour, wall_metre);
}

cv::Mat wallpaper(FurnitureKit* kit, const Wall& wall, const cv::Scalar& colour) {
  return wallpaper_print(kit->rng, wall_texels(wall.length, wall.height), colour, wall_metre);
}

cv::Mat parquet(FurnitureKit* kit, const RoomShape& room, const cv::Scalar& colour) {
  constexpr double metre = 300.0;
  return parquet_print(
      kit->rng,
      {cvRound((room.right - room.left) * metre), cvRound((room.front - room.back) * metre)},
      colour, metre);
}

/// Posters of their own kind along a wall, from `from` to `to`.
void hang_row(FurnitureKit* kit, const Wall& wall, double from, double to) {
  cv::RNG& rng = kit->rng;
  double x = from;
  while (true) {
    const double width = rng.uniform(0.35, 0.75), height = width * rng.uniform(0.7, 1.4);
    if (x + width > to) return;
    hang(kit, wall, x, rng.uniform(1.75, 2.1), width, height,
         any_poster_print(rng, texels(width, height)));
    x += width + rng.uniform(0.15, 0.4);
  }
}

void build_corridor(FurnitureKit* kit, std::vector<Vector3d>* lamps) {
  cv::RNG& rng = kit->rng;
  const Material skirting = kit->wood({215, 222, 226});
  const Wall front = wall_of(corridor, Side::front), right = wall_of(corridor, Side::right);
  const Wall back = wall_of(corridor, Side::back), left = wall_of(corridor, Side::left);
  add_floor(kit, corridor, parquet(kit, corridor, {74, 112, 150}));
  add_ceiling(kit, corridor);
  add_wall(kit, front, plaster(kit, front, {188, 206, 214}), {corridor_to_living}, skirting);
  add_wall(kit, right, wallpaper(kit, right, {190, 205, 200}), {}, skirting);
  add_wall(kit, back, plaster(kit, back, {186, 202, 212}), {}, skirting);
  add_wall(kit, left, plaster(kit, left, {192, 208, 216}), {corridor_to_office}, skirting);
  add_door_frame(kit, front, corridor_to_living);
  hang_row(kit, left, 1.7, 5.6);
  hang_row(kit, right, 0.3, 3.2);
  hang(kit, back, 0.35, 2.05, 0.7, 1.4, door_print(rng, texels(0.7, 1.4), {110, 150, 185}));
  add_socket(kit, left, 2.4);
  // Shoes and coats.
  kit->place(cupboard(rng, {1.0, 0.28, 0.85}, {95, 130, 165}, 2, 2), {4.05, -0.6, 0.0},
             -0.5 * CV_PI);
  kit->place(stack_of_papers(rng), {4.05, -0.8, 0.85}, 1.0);
  kit->place(cardboard_box(rng, {0.30, 0.26, 0.34}), {3.98, 2.95, 0.0}, 0.15);
  for (int i = 0; i < 4; ++i) {
    const double z = rng.uniform(0.75, 0.95), wide = rng.uniform(0.10, 0.13);
    Mesh coat = lathe_mesh({{0.02, 1.75 - z},
                            {0.05, 1.70 - z},
                            {wide, 1.60 - z},
                            {wide, 1.3 - z},
                            {wide * 1.15, 0.0},
                            {0.9 * wide, 0.02}},
                           20, kit->cloth(room_colour(rng, 30, 130)).texture);
    for (Eigen::Vector3f& v : coat.rest.vertices) v.x() *= 0.45F;
    kit->block({4.18, -1.95 + 0.27 * i, 1.72}, {0.04, 0.03, 0.03}, kit->smooth({60, 60, 62}));
    kit->add(standing({4.12, -1.95 + 0.27 * i, z}, rng.uniform(-0.1, 0.1)) * coat);
  }
  kit->picture({3.2, 2.4, 0.006}, {0.6, 0, 0}, {0, -2.6, 0},
               make_texture(rug_print(rng, texels(0.6, 2.6))));
  lamps->push_back(add_lamp(kit, 3.5, -1.0, corridor.height));
  lamps->push_back(add_lamp(kit, 3.5, 2.0, corridor.height));
}

void furnish_living_room(FurnitureKit* kit) {
  cv::RNG& rng = kit->rng;
  kit->picture({5.2, 6.8, 0.008}, {1.7, 0, 0}, {0, -2.4, 0},
               make_texture(rug_print(rng, texels(1.7, 2.4))));
  kit->place(sofa(rng), {7.45, 5.6, 0.0}, -0.5 * CV_PI);
  kit->place(table(rng, 1.1, 0.6, 0.45), {6.35, 5.6, 0.0}, 0.5 * CV_PI);
  kit->place(mug(rng), {6.3, 5.4, 0.45}, 1.0);
  kit->place(stack_of_papers(rng), {6.4, 5.8, 0.45}, 0.7);
  kit->place(book_shelf(rng, 1.2, 2.0), {6.9, 7.62, 0.0});
  kit->place(book_shelf(rng, 0.8, 1.3), {3.3, 7.62, 0.0});
  kit->place(mug(rng), {3.2, 7.6, 1.3}, 2.0);
  kit->place(floor_lamp(rng), {7.65, 7.3, 0.0});
  kit->place(potted_plant(rng), {7.6, 3.8, 0.0});
  kit->place(cupboard(rng, {1.6, 0.42, 0.6}, {70, 95, 125}, 3, 1), {6.0, 3.62, 0.0}, CV_PI);
  // A television on it.
  kit->block({6.0, 3.6, 1.0}, {1.2, 0.06, 0.68}, kit->smooth({30, 30, 32}));
  kit->picture({6.58, 3.632, 1.32}, {-1.16, 0, 0}, {0, 0, -0.64},
               make_texture(landscape_print(rng, {700, 386})), 0.45F);
  kit->place(plain_chair(rng), {3.15, 5.0, 0.0}, 0.5 * CV_PI);
  kit->place(cardboard_box(rng, {0.45, 0.35, 0.3}), {4.6, 7.5, 0.0}, 0.2);
}

void build_living_room(FurnitureKit* kit, std::vector<Vector3d>* lamps) {
  cv::RNG& rng = kit->rng;
  const Material skirting = kit->wood({60, 85, 110});
  const Wall front = wall_of(living_room, Side::front), right = wall_of(living_room, Side::right);
  const Wall back = wall_of(living_room, Side::back), left = wall_of(living_room, Side::left);
  const Opening window = {1.5, 3.3, 0.9, 2.25};
  add_floor(kit, living_room, parquet(kit, living_room, {90, 135, 172}));
  add_ceiling(kit, living_room);
  add_wall(kit, front, wallpaper(kit, front, {178, 200, 196}), {window}, skirting);
  add_wall(kit, right, wallpaper(kit, right, {170, 186, 205}), {}, skirting);
  add_wall(kit, back, plaster(kit, back, {186, 202, 214}), {living_to_corridor}, skirting);
  add_wall(kit, left, wallpaper(kit, left, {176, 196, 204}), {living_to_kitchen}, skirting);
  add_window(kit, front, window);
  add_radiator(kit, front, 1.8, 1.2);
  add_door_frame(kit, left, living_to_kitchen);
  hang_row(kit, right, 0.8, 4.0);
  hang_row(kit, back, 0.3, 1.2);
  hang_row(kit, back, 2.9, 3.9);
  hang_row(kit, left, 0.3, 2.3);
  hang(kit, front, 0.2, 2.3, 0.7, 0.5, landscape_print(rng, texels(0.7, 0.5)));
  add_socket(kit, left, 3.8);
  furnish_living_room(kit);
  for (const double x : {4.2, 6.7}) {
    lamps->push_back(add_lamp(kit, x, 5.6, living_room.height));
  }
}

/// A worktop with sink and stove, cupboards over it, a fridge.
void furnish_kitchen(FurnitureKit* kit) {
  cv::RNG& rng = kit->rng;
  const cv::Scalar fronts(200, 212, 216);
  const Material steel = kit->smooth({165, 168, 170}), stone = kit->smooth({95, 98, 104});
  kit->place(cupboard(rng, {3.0, 0.58, 0.86}, fronts, 5, 1), {-1.0, 7.2, 0.0});
  kit->block({-1.0, 7.19, 0.88}, {3.04, 0.62, 0.04}, stone);
  kit->place(cupboard(rng, {2.0, 0.34, 0.65}, fronts, 4, 1), {-1.4, 7.33, 1.5});
  kit->block({-0.3, 7.18, 0.904}, {0.56, 0.50, 0.008}, kit->smooth({28, 28, 30}));
  for (const double x : {-0.43, -0.17}) {
    for (const double y : {7.06, 7.30}) {
      kit->turned({x, y, 0.908}, {{0.0, 0.004}, {0.09, 0.003}, {0.095, 0.0}}, 24, steel);
    }
  }
  kit->turned({-0.17, 7.06, 0.912}, {{0.10, 0.14}, {0.105, 0.14}, {0.105, 0.0}}, 28, steel);  // pot
  kit->block({-1.6, 7.18, 0.905}, {0.6, 0.44, 0.012}, steel);
  kit->turned({-1.6, 7.40, 0.9}, {{0.012, 0.28}, {0.014, 0.0}}, 12, steel);
  kit->place(mug(rng), {-0.8, 7.15, 0.9}, 0.4);
  kit->place(mug(rng), {-0.95, 7.28, 0.9}, 2.4);
  kit->block({0.25, 7.22, 1.03}, {0.26, 0.2, 0.26}, kit->smooth({50, 55, 120}));  // a machine
  kit->place(book_row(rng, 0.3, 0.28, 0.2), {-2.3, 7.3, 0.9});

  kit->block({0.95, 7.17, 0.95}, {0.65, 0.62, 1.9}, kit->smooth({205, 208, 210}));  // fridge
  kit->block({0.68, 6.85, 1.35}, {0.025, 0.03, 0.5}, steel);
  for (int i = 0; i < 7; ++i) {
    const double w = rng.uniform(0.08, 0.18), x = 0.75 + 0.06 * i;
    kit->picture({x, 6.857 - 4e-4 * i, rng.uniform(1.0, 1.8)}, {w, 0, 0}, {0, 0, -1.3 * w},
                 make_texture(any_poster_print(rng, texels(w, 1.3 * w))));
  }
  kit->place(table(rng, 1.4, 0.8, 0.75), {-1.35, 5.3, 0.0}, 0.1);
  kit->place(plain_chair(rng), {-1.65, 4.7, 0.0}, CV_PI + 0.2);
  kit->place(plain_chair(rng), {-1.0, 4.72, 0.0}, CV_PI - 0.3);
  kit->place(plain_chair(rng), {-1.35, 5.95, 0.0}, -0.1);
  kit->turned({-1.3, 5.3, 0.75}, {{0.16, 0.08}, {0.165, 0.08}, {0.10, 0.0}, {0.0, 0.0}}, 28,
              {make_texture(tiles_print(rng, {256, 64}, {150, 120, 90}, 0.2, 128.0)), 1.0});
  for (int i = 0; i < 5; ++i) {
    Mesh fruit =
        ellipsoid_mesh({0.04, 0.04, 0.038}, 14, kit->smooth(room_colour(rng, 40, 220)).texture);
    const double angle = 1.26 * i;
    kit->add(standing({-1.3 + 0.07 * std::cos(angle), 5.3 + 0.07 * std::sin(angle), 0.83}, angle) *
             fruit);
  }
  kit->place(stack_of_papers(rng), {-0.9, 5.25, 0.75}, 0.4);
  kit->place(cupboard(rng, {1.2, 0.4, 0.9}, {105, 140, 170}, 2, 2), {-0.2, 3.62, 0.0}, CV_PI);
  kit->place(cardboard_box(rng, {0.34, 0.28, 0.22}), {-0.45, 3.62, 0.9}, 0.3);
  kit->place(potted_plant(rng), {0.12, 3.75, 0.9});
  kit->place(waste_bin(rng), {0.75, 3.65, 0.0});
  kit->place(cardboard_box(rng, {0.4, 0.3, 0.35}), {-2.4, 3.7, 0.0}, 0.3);
}

void build_kitchen(FurnitureKit* kit, std::vector<Vector3d>* lamps) {
  cv::RNG& rng = kit->rng;
  const Material skirting = kit->smooth({200, 205, 208});
  const Wall front = wall_of(kitchen, Side::front), right = wall_of(kitchen, Side::right);
  const Wall back = wall_of(kitchen, Side::back), left = wall_of(kitchen, Side::left);
  const Opening window = {1.4, 3.0, 0.95, 2.2};
  constexpr double metre = 300.0;
  add_floor(kit, kitchen,
            tiles_print(rng,
                        {cvRound((kitchen.right - kitchen.left) * metre),
                         cvRound((kitchen.front - kitchen.back) * metre)},
                        {150, 165, 176}, 0.3, metre));
  add_ceiling(kit, kitchen);
  add_wall(
      kit, front,
      tiles_print(rng, wall_texels(front.length, front.height), {205, 214, 216}, 0.15, wall_metre),
      {}, skirting);
  add_wall(kit, right, plaster(kit, right, {170, 208, 220}), {kitchen_to_living}, skirting);
  add_wall(kit, back, plaster(kit, back, {176, 208, 218}), {kitchen_to_office}, skirting);
  add_wall(kit, left, plaster(kit, left, {172, 210, 222}), {window}, skirting);
  add_window(kit, left, window);
  add_radiator(kit, left, 1.6, 1.1);
  hang_row(kit, right, 1.9, 3.9);
  hang_row(kit, back, 1.3, 5.0);
  hang(kit, left, 0.3, 2.0, 0.6, 0.8, chart_print(rng, texels(0.6, 0.8)));
  hang(kit, left, 3.25, 2.0, 0.5, 0.6, any_poster_print(rng, texels(0.5, 0.6)));
  add_clock(kit, front, 4.5, 2.3);
  add_socket(kit, front, 3.2, 1.15);
  add_socket(kit, right, 1.8, 1.1);
  furnish_kitchen(kit);
  for (const double x : {-1.2, 1.3}) lamps->push_back(add_lamp(kit, x, 5.4, kitchen.height));
}

}  // namespace

Place flat(cv::RNG& rng) {
  FurnitureKit kit(rng);
  Place place;
  OfficePlan plan;
  plan.door_to_corridor_open = true;
  plan.door_to_kitchen = true;
  place.lamps = build_office(&kit, plan);
  build_corridor(&kit, &place.lamps);
  build_living_room(&kit, &place.lamps);
  build_kitchen(&kit, &place.lamps);
  place.meshes = std::move(kit.meshes);
  return place;
}

std::vector<Eigen::Vector2d> flat_loop() {
  return {{0.0, 0.3},  {0.8, -0.9},  {1.8, -1.45}, {2.8, -1.45}, {3.45, -0.9},
          {3.45, 1.0}, {3.5, 3.3},   {3.8, 4.4},   {4.8, 5.0},   {5.0, 5.9},
          {4.1, 6.35}, {2.75, 6.35}, {1.5, 6.2},   {0.5, 5.5},   {0.8, 4.6},
          {1.8, 4.2},  {2.15, 3.35}, {2.0, 2.3},   {1.4, 1.1}};
}

}  // namespace dkp_slam
