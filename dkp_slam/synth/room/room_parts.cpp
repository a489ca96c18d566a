#include "dkp_slam/synth/room/room_parts.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/synth/mesh/texture.h"
#include "dkp_slam/synth/room/prints.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

Vector3d up(double metres) { return {0, 0, metres}; }

/// A box against a wall: its middle and its size along the wall, off it and upwards.
void block_on(FurnitureKit* kit, const Wall& wall, const Vector3d& centre, double along, double off,
              double high, const Material& material) {
  kit->block(centre, {along, off, high}, material, std::atan2(wall.along.y(), wall.along.x()));
}

}  // namespace

double Wall::yaw() const { return std::atan2(along.y(), along.x()); }

Wall wall_of(const RoomShape& room, Side side) {
  const double width = room.right - room.left, depth = room.front - room.back;
  switch (side) {
    case Side::front:
      return {{room.left, room.front, 0}, Vector3d::UnitX(), width, room.height};
    case Side::right:
      return {{room.right, room.front, 0}, -Vector3d::UnitY(), depth, room.height};
    case Side::back:
      return {{room.right, room.back, 0}, -Vector3d::UnitX(), width, room.height};
    case Side::left:
      break;
  }
  return {{room.left, room.back, 0}, Vector3d::UnitY(), depth, room.height};
}

Opening doorway(double from) { return {from, from + door_width, 0.0, door_height}; }

cv::Size wall_texels(double width, double height) {
  return {std::max(cvRound(width * wall_metre), 8), std::max(cvRound(height * wall_metre), 8)};
}

void add_wall(FurnitureKit* kit, const Wall& wall, const cv::Mat& print,
              const std::vector<Opening>& openings, const Material& skirting) {
  const TexturePtr texture = make_texture(print);
  const auto sheet = [&](double from, double to, double bottom, double top) {
    if (to - from < 1e-6 || top - bottom < 1e-6) return;
    Mesh mesh = panel_mesh(wall.at(from, top), (to - from) * wall.along, up(bottom - top), texture);
    for (Eigen::Vector2f& uv : mesh.uv) {
      uv.x() = static_cast<float>((from + uv.x() * (to - from)) / wall.length);
      uv.y() = static_cast<float>((wall.height - top + uv.y() * (top - bottom)) / wall.height);
    }
    for (Eigen::Vector3i& t : mesh.triangles) std::swap(t.y(), t.z());
    for (Eigen::Vector3f& n : mesh.rest.normals) n = -n;
    kit->add(std::move(mesh));
  };
  constexpr double board = 0.08, thick = 0.015;
  const auto skirt = [&](double from, double to) {
    if (to - from < 0.02) return;
    block_on(kit, wall, wall.at(0.5 * (from + to), 0.5 * board, 0.5 * thick), to - from, thick,
             board, skirting);
  };
  double from = 0.0, board_from = 0.0;
  for (const Opening& hole : openings) {  // from left to right
    sheet(from, hole.from, 0.0, wall.height);
    sheet(hole.from, hole.to, hole.top, wall.height);
    sheet(hole.from, hole.to, 0.0, hole.bottom);
    from = hole.to;
    if (hole.bottom > board) continue;
    skirt(board_from, hole.from - 0.06);
    board_from = hole.to + 0.06;
  }
  sheet(from, wall.length, 0.0, wall.height);
  skirt(board_from, wall.length);
}

void add_floor(FurnitureKit* kit, const RoomShape& room, const cv::Mat& print) {
  kit->picture({room.left, room.front, 0}, {room.right - room.left, 0, 0},
               {0, room.back - room.front, 0}, make_texture(print));
}

void add_ceiling(FurnitureKit* kit, const RoomShape& room) {
  const double width = room.right - room.left, depth = room.front - room.back;
  constexpr double metre = 160.0;
  kit->picture({room.left, room.back, room.height}, {width, 0, 0}, {0, depth, 0},
               make_texture(ceiling_print(
                   kit->rng, {cvRound(width * metre), cvRound(depth * metre)}, metre)));
}

Vector3d add_lamp(FurnitureKit* kit, double x, double y, double ceiling) {
  constexpr double half = 0.3, rim = 0.02, deep = 0.04;
  const Material frame = kit->smooth({170, 172, 174});
  for (const double side : {-1.0, 1.0}) {
    kit->block({x + side * half, y, ceiling - 0.5 * deep}, {rim, 2 * half + rim, deep}, frame);
    kit->block({x, y + side * half, ceiling - 0.5 * deep}, {2 * half - rim, rim, deep}, frame);
  }
  cv::Mat print(64, 64, CV_8UC3, cv::Scalar(245, 250, 255));
  for (int i = 0; i < 64; i += 16) {  // a grid under the tubes
    cv::line(print, {i, 0}, {i, 64}, {215, 220, 225}, 1);
    cv::line(print, {0, i}, {64, i}, {215, 220, 225}, 1);
  }
  constexpr float glow = 2.5F;
  kit->picture({x - half, y - half, ceiling - 0.02}, {2 * half, 0, 0}, {0, 2 * half, 0},
               make_texture(print), glow);
  kit->meshes.back().is_lamp = true;
  return {x, y, ceiling - 0.06};
}

void add_window(FurnitureKit* kit, const Wall& wall, const Opening& o) {
  const Material frame = kit->smooth({222, 226, 228});
  const double width = o.to - o.from, height = o.top - o.bottom, middle = 0.5 * (o.from + o.to);
  constexpr double deep = 0.16, bar = 0.05;
  const double z = 0.5 * (o.bottom + o.top);
  for (const double side : {-1.0, 1.0}) {
    block_on(kit, wall, wall.at(middle + side * 0.5 * (width + 0.02), z, -0.5 * deep - 0.001), 0.03,
             deep, height + 0.06, frame);
    block_on(kit, wall, wall.at(middle, z + side * 0.5 * (height + 0.02), -0.5 * deep - 0.001),
             width, deep, 0.03, frame);
    block_on(kit, wall, wall.at(middle + side * 0.5 * (width - bar), z, -0.10), bar, 0.05, height,
             frame);
    block_on(kit, wall, wall.at(middle, z + side * 0.5 * (height - bar), -0.10), width - 2 * bar,
             0.05, bar, frame);
  }
  block_on(kit, wall, wall.at(middle, z, -0.10), bar, 0.045, height - 2 * bar, frame);
  block_on(kit, wall, wall.at(middle, o.bottom - 0.015, 0.07), width + 0.16, 0.18, 0.03, frame);
  // The street lies some way behind, so that it moves against the frame.
  constexpr double behind = 0.9, margin = 1.1;
  const Vector3d corner = wall.at(o.from - margin, o.top + margin, -behind);
  constexpr float daylight = 1.3F;
  kit->picture(corner, (width + 2 * margin) * wall.along, up(-(height + 2 * margin)),
               make_texture(street_print(kit->rng, {900, 720})), daylight);
}

void add_door_frame(FurnitureKit* kit, const Wall& wall, const Opening& o) {
  const Material frame = kit->smooth({205, 212, 216});
  constexpr double bar = 0.06;
  const double deep = wall_thickness + 0.02, off = -0.5 * wall_thickness;
  for (const double x : {o.from - 0.5 * bar + 0.01, o.to + 0.5 * bar - 0.01}) {
    block_on(kit, wall, wall.at(x, 0.5 * (o.top + bar), off), bar, deep, o.top + bar, frame);
  }
  block_on(kit, wall, wall.at(0.5 * (o.from + o.to), o.top + 0.5 * bar - 0.01, off),
           o.to - o.from - 0.02, deep, bar, frame);
  constexpr double sill = 0.012;
  block_on(kit, wall, wall.at(0.5 * (o.from + o.to), 0.5 * sill, off), o.to - o.from, deep, sill,
           kit->wood({90, 125, 155}));
}

void add_door_leaf(FurnitureKit* kit, const Wall& wall, const Opening& o, double angle,
                   const cv::Scalar& colour) {
  constexpr double thick = 0.04, gap = 0.012;
  const double width = o.to - o.from - 2 * gap, height = o.top - gap;
  FurnitureKit leaf(kit->rng);
  leaf.block({0.5 * width, 0, 0.5 * height}, {width, thick, height}, leaf.wood(colour));
  const cv::Size texels(cvRound(width * 400.0), cvRound(height * 400.0));
  leaf.picture({0, -0.5 * thick - 0.001, height}, {width, 0, 0}, up(-height),
               make_texture(door_print(kit->rng, texels, colour)));
  leaf.picture({width, 0.5 * thick + 0.001, height}, {-width, 0, 0}, up(-height),
               make_texture(door_print(kit->rng, texels, colour)));
  // The hinge is on the left, the leaf turns into the room.
  kit->place(leaf.meshes, wall.at(o.from + gap, 0.004, -0.5 * thick - 0.005), wall.yaw() - angle);
}

void hang(FurnitureKit* kit, const Wall& wall, double right, double top, double width,
          double height, const cv::Mat& print, bool framed) {
  constexpr double rim = 0.02, thick = 0.02;
  double off = 0.002;
  if (framed) {
    const Material frame = kit->smooth(room_colour(kit->rng, 30, 120));
    block_on(kit, wall, wall.at(right + 0.5 * width, top - 0.5 * height, 0.5 * thick),
             width + 2 * rim, thick, height + 2 * rim, frame);
    off = thick + 0.001;
  }
  kit->picture(wall.at(right, top, off), width * wall.along, up(-height), make_texture(print));
}

void add_socket(FurnitureKit* kit, const Wall& wall, double right, double height) {
  const Material plastic = kit->smooth({225, 228, 228});
  block_on(kit, wall, wall.at(right, height, 0.006), 0.16, 0.012, 0.08, plastic);
  cv::Mat print(40, 80, CV_8UC3, cv::Scalar(222, 226, 226));
  for (const int x : {20, 60}) {
    cv::circle(print, {x, 20}, 14, {190, 195, 195}, cv::FILLED, cv::LINE_AA);
    cv::circle(print, {x - 5, 20}, 2, {30, 30, 30}, cv::FILLED, cv::LINE_AA);
    cv::circle(print, {x + 5, 20}, 2, {30, 30, 30}, cv::FILLED, cv::LINE_AA);
  }
  kit->picture(wall.at(right - 0.075, height + 0.036, 0.013), 0.15 * wall.along, up(-0.072),
               make_texture(print));
}

void add_radiator(FurnitureKit* kit, const Wall& wall, double right, double width) {
  const Material enamel = kit->smooth({224, 228, 230});
  constexpr double pitch = 0.06;
  const int ribs = std::max(static_cast<int>(width / pitch), 2);
  for (int i = 0; i < ribs; ++i) {
    block_on(kit, wall, wall.at(right + pitch * (i + 0.5), 0.42, 0.09), 0.04, 0.09, 0.58, enamel);
  }
  for (const double z : {0.20, 0.64}) {
    block_on(kit, wall, wall.at(right + 0.5 * pitch * ribs, z, 0.09), pitch * ribs, 0.03, 0.03,
             enamel);
  }
}

void add_clock(FurnitureKit* kit, const Wall& wall, double right, double top) {
  constexpr int texels = 160;
  constexpr double side = 0.28;
  cv::Mat print(texels, texels, CV_8UC3, cv::Scalar(240, 242, 244));
  const cv::Point middle(texels / 2, texels / 2);
  cv::circle(print, middle, texels / 2 - 6, {30, 30, 30}, 8, cv::LINE_AA);
  for (int i = 0; i < 12; ++i) {
    const double a = CV_PI * i / 6.0;
    const auto dot = [&](double r) {
      return middle + cv::Point(cvRound(r * std::cos(a)), cvRound(r * std::sin(a)));
    };
    cv::line(print, dot(58.0), dot(i % 3 == 0 ? 46.0 : 52.0), {20, 20, 20}, 4, cv::LINE_AA);
  }
  cv::line(print, middle, middle + cv::Point(22, -26), {20, 20, 20}, 6, cv::LINE_AA);
  cv::line(print, middle, middle + cv::Point(-40, -28), {20, 20, 20}, 4, cv::LINE_AA);
  hang(kit, wall, right, top, side, side, print);
}

}  // namespace dkp_slam
