#include <cmath>

#include "dkp_slam/synth/room/furniture.h"
#include "dkp_slam/synth/room/prints.h"
#include "dkp_slam/synth/room/room_parts.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

cv::Size poster_texels(double width, double height) {
  constexpr double metre = 420.0;
  return {cvRound(width * metre), cvRound(height * metre)};
}

void add_walls(FurnitureKit* kit, const OfficePlan& plan) {
  cv::RNG& rng = kit->rng;
  const Material skirting = kit->wood({150, 170, 182});
  const auto plaster = [&](const Wall& wall, const cv::Scalar& colour) {
    return plaster_print(rng, wall_texels(wall.length, wall.height), colour, wall_metre);
  };
  const Wall front = wall_of(plan.room, Side::front), right = wall_of(plan.room, Side::right);
  const Wall back = wall_of(plan.room, Side::back), left = wall_of(plan.room, Side::left);
  const Opening to_kitchen = doorway(4.40), to_corridor = doorway(4.30);
  const Opening window = {2.1, 4.3, 0.95, 2.25};

  add_wall(kit, front, plaster(front, {196, 206, 212}),
           plan.door_to_kitchen ? std::vector<Opening>{to_kitchen} : std::vector<Opening>{},
           skirting);
  add_wall(kit, right, plaster(right, {186, 200, 204}), {to_corridor}, skirting);
  add_wall(kit, back, plaster(back, {198, 204, 200}), {}, skirting);
  add_wall(kit, left, plaster(left, {190, 202, 208}), {window}, skirting);
  add_window(kit, left, window);
  add_radiator(kit, left, 2.5, 1.3);
  add_door_frame(kit, right, to_corridor);
  const cv::Scalar beech(120, 168, 200);
  add_door_leaf(kit, right, to_corridor, plan.door_to_corridor_open ? 1.75 : 0.0, beech);
  if (plan.door_to_kitchen) {
    add_door_frame(kit, front, to_kitchen);
  } else {
    hang(kit, front, 4.5, 2.0, 0.6, 0.85, any_poster_print(rng, poster_texels(0.6, 0.85)));
  }

  // Above the desk: a cork board and what is pinned beside it.
  hang(kit, front, 2.15, 2.05, 1.15, 0.75, cork_board_print(rng, poster_texels(1.15, 0.75)));
  hang(kit, front, 3.45, 2.15, 0.50, 0.70, landscape_print(rng, poster_texels(0.5, 0.7)));
  hang(kit, front, 1.62, 2.10, 0.40, 0.56, chart_print(rng, poster_texels(0.4, 0.56)), false);
  hang(kit, front, 3.52, 1.30, 0.21, 0.30, page_print(rng, poster_texels(0.21, 0.3)), false);
  add_clock(kit, front, 2.55, 2.45);
  add_socket(kit, front, 1.5);
  add_socket(kit, front, 3.3, 0.9);

  hang(kit, right, 1.0, 1.95, 1.8, 1.05, whiteboard_print(rng, poster_texels(1.8, 1.05)), false);
  hang(kit, right, 3.1, 2.05, 0.60, 0.84, chart_print(rng, poster_texels(0.6, 0.84)));
  hang(kit, right, 0.25, 2.0, 0.45, 0.62, any_poster_print(rng, poster_texels(0.45, 0.62)));
  add_socket(kit, right, 4.15, 1.1);
  add_socket(kit, right, 3.0);

  hang(kit, left, 0.35, 2.05, 0.9, 0.64, landscape_print(rng, poster_texels(0.9, 0.64)));
  hang(kit, left, 1.42, 1.95, 0.42, 0.6, any_poster_print(rng, poster_texels(0.42, 0.6)));
  hang(kit, left, 4.55, 2.0, 0.55, 0.75, chart_print(rng, poster_texels(0.55, 0.75)));
  add_socket(kit, left, 4.8);

  hang(kit, back, 0.5, 2.0, 0.7, 0.98, any_poster_print(rng, poster_texels(0.7, 0.98)));
  hang(kit, back, 1.5, 2.1, 1.2, 0.8, landscape_print(rng, poster_texels(1.2, 0.8)));
  hang(kit, back, 3.2, 2.0, 0.5, 0.7, chart_print(rng, poster_texels(0.5, 0.7)), false);
  hang(kit, back, 4.2, 2.0, 0.6, 0.84, any_poster_print(rng, poster_texels(0.6, 0.84)));
  add_socket(kit, back, 2.9);
}

void add_work_places(FurnitureKit* kit) {
  cv::RNG& rng = kit->rng;
  constexpr double top = 0.74;
  const Vector3d main(0.0, 2.05, 0.0);
  kit->place(desk(rng, 1.9, 0.8), main);
  const auto on_desk = [&](const std::vector<Mesh>& piece, double x, double y, double yaw) {
    kit->place(piece, main + Vector3d(x, y, top), yaw);
  };
  on_desk(monitor(rng), -0.36, 0.16, 0.16);
  on_desk(monitor(rng), 0.34, 0.17, -0.14);
  on_desk(keyboard_and_mouse(rng), -0.10, -0.20, 0.04);
  on_desk(mug(rng), 0.44, -0.14, 0.8);
  on_desk(stack_of_papers(rng), 0.68, -0.16, 0.3);
  on_desk(stack_of_papers(rng), -0.72, -0.18, -0.2);
  on_desk(desk_lamp(rng), -0.82, 0.22, 0.6);
  on_desk(book_row(rng, 0.26, 0.28, 0.2), 0.80, 0.22, -0.2);
  kit->place(drawer_cabinet(rng), main + Vector3d(0.62, 0.02, 0.0));
  for (int i = 0; i < 3; ++i) {
    kit->place(cabinet_drawer(rng, i), main + Vector3d(0.62, 0.02, 0.0));
  }
  kit->place(office_chair(rng), main + Vector3d(-0.25, -0.62, 0.0), 2.7);
  kit->place(waste_bin(rng), main + Vector3d(-1.15, -0.1, 0.0));

  // A second place under the window.
  const Vector3d second(-2.28, 0.75, 0.0);
  const double yaw = 0.5 * CV_PI;
  kit->place(desk(rng, 1.5, 0.7), second, yaw);
  kit->place(monitor(rng), second + Vector3d(-0.12, 0.1, top), yaw + 0.2);
  kit->place(keyboard_and_mouse(rng), second + Vector3d(0.17, 0.0, top), yaw);
  kit->place(stack_of_papers(rng), second + Vector3d(0.12, -0.5, top), 1.2);
  kit->place(mug(rng), second + Vector3d(0.08, 0.45, top), 0.2);
  kit->place(office_chair(rng), second + Vector3d(0.72, -0.1, 0.0), -1.2);
}

void add_along_the_walls(FurnitureKit* kit, const OfficePlan& plan) {
  cv::RNG& rng = kit->rng;
  const RoomShape& room = plan.room;
  kit->place(book_shelf(rng, 1.1, 1.95), {-1.95, room.front - 0.17, 0.0});
  kit->place(potted_plant(rng), {-1.12, room.front - 0.38, 0.0});
  kit->place(cardboard_box(rng, {0.32, 0.24, 0.22}), {-2.05, room.front - 0.18, 1.95}, 0.2);

  const double right = room.right;
  kit->place(cupboard(rng, {1.1, 0.42, 0.80}, {150, 172, 186}, 2, 1), {right - 0.22, 1.35, 0.0},
             -0.5 * CV_PI);
  kit->place(stack_of_papers(rng), {right - 0.25, 1.65, 0.80}, 1.4);
  kit->place(potted_plant(rng), {right - 0.34, 1.02, 0.80}, 0.4);
  kit->place(cardboard_box(rng, {0.40, 0.30, 0.28}), {right - 0.28, 0.30, 0.0}, 1.3);
  kit->place(cardboard_box(rng, {0.30, 0.26, 0.20}), {right - 0.27, 0.29, 0.28}, 1.7);

  kit->place(book_shelf(rng, 0.9, 1.25), {1.95, room.back + 0.17, 0.0}, CV_PI);
  kit->place(cupboard(rng, {0.9, 0.45, 1.10}, {120, 126, 128}, 2, 2), {-1.0, room.back + 0.24, 0.0},
             CV_PI);
  kit->place(cardboard_box(rng, {0.36, 0.30, 0.24}), {-1.1, room.back + 0.25, 1.10}, 0.3);
  kit->place(plain_chair(rng), {0.45, room.back + 0.35, 0.0}, CV_PI - 0.3);
  kit->place(cardboard_box(rng, {0.50, 0.40, 0.42}), {-2.2, room.back + 0.4, 0.0}, 0.2);
  kit->place(cardboard_box(rng, {0.38, 0.30, 0.30}), {-2.22, room.back + 0.38, 0.42}, -0.2);
}

}  // namespace

std::vector<Vector3d> build_office(FurnitureKit* kit, const OfficePlan& plan) {
  const RoomShape& room = plan.room;
  constexpr double metre = 320.0;
  const cv::Size floor(cvRound((room.right - room.left) * metre),
                       cvRound((room.front - room.back) * metre));
  add_floor(kit, room, carpet_tiles_print(kit->rng, floor, {112, 106, 102}, metre));
  add_ceiling(kit, room);
  add_walls(kit, plan);
  add_work_places(kit);
  add_along_the_walls(kit, plan);
  std::vector<Vector3d> lamps;
  for (const double x : {-1.3, 1.3}) {
    for (const double y : {-0.9, 1.6}) lamps.push_back(add_lamp(kit, x, y, room.height));
  }
  return lamps;
}

Place office(cv::RNG& rng) {
  FurnitureKit kit(rng);
  Place place;
  place.lamps = build_office(&kit, OfficePlan());
  place.meshes = std::move(kit.meshes);
  return place;
}

}  // namespace dkp_slam
