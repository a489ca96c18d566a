#pragma once

#include <vector>

#include "dkp_slam/synth/room/furniture_kit.h"

namespace dkp_slam {

/// A rectangular room: inner measures, metres.
struct RoomShape {
  double left, right, back, front;  ///< x from, x to, y from, y to
  double height = 2.7;
};

/// A wall seen from inside its room.
struct Wall {
  Eigen::Vector3d foot;   ///< of its left end
  Eigen::Vector3d along;  ///< to its right end, unit length
  double length = 0.0, height = 2.7;

  Eigen::Vector3d inwards() const { return (-Eigen::Vector3d::UnitZ()).cross(along); }
  /// `right` of the left end, `up` from the floor, `off` into the room.
  Eigen::Vector3d at(double right, double up, double off = 0.0) const {
    return foot + right * along + Eigen::Vector3d(0, 0, up) + off * inwards();
  }
  /// Turn that lets furniture stand with its back to this wall.
  double yaw() const;
};

enum class Side { front, right, back, left };  ///< the wall at y max, x max, y min, x min
Wall wall_of(const RoomShape& room, Side side);

/// A hole in a wall: metres from its left end and from the floor.
struct Opening {
  double from, to, bottom, top;
};
Opening doorway(double from);  ///< 0.9 m wide
constexpr double door_width = 0.9, door_height = 2.05;
constexpr double wall_thickness = 0.1;  ///< between two rooms

/// A wall's sheet around its openings, covered with `print` as a whole; a skirting board.
void add_wall(FurnitureKit* kit, const Wall& wall, const cv::Mat& print,
              const std::vector<Opening>& openings, const Material& skirting);
void add_floor(FurnitureKit* kit, const RoomShape& room, const cv::Mat& print);
void add_ceiling(FurnitureKit* kit, const RoomShape& room);
/// A luminous panel of 60 x 60 cm under the ceiling; the lamp's place for `Place::lamps`.
Eigen::Vector3d add_lamp(FurnitureKit* kit, double x, double y, double ceiling);
/// Frame, sill, cross bar and the street behind a window's opening.
void add_window(FurnitureKit* kit, const Wall& wall, const Opening& opening);
/// Frame in a doorway; with `leaf_yaw` a door that stands open so far, 0: closed.
void add_door_frame(FurnitureKit* kit, const Wall& wall, const Opening& opening);
void add_door_leaf(FurnitureKit* kit, const Wall& wall, const Opening& opening, double angle,
                   const cv::Scalar& colour);
/// A picture on the wall, its top left corner at (`right`, `up`); with a frame around it.
void hang(FurnitureKit* kit, const Wall& wall, double right, double up, double width, double height,
          const cv::Mat& print, bool framed = true);
/// Socket, switch, radiator: what every wall has.
void add_socket(FurnitureKit* kit, const Wall& wall, double right, double up = 0.3);
void add_radiator(FurnitureKit* kit, const Wall& wall, double right, double width);
void add_clock(FurnitureKit* kit, const Wall& wall, double right, double up);

/// Size of a print for so many metres, and how many of its texels make a metre.
cv::Size wall_texels(double width, double height);
constexpr double wall_metre = 256.0;

/// The office's furniture, and what hangs on its walls; the flat shares it.
struct OfficePlan {
  RoomShape room = {-2.7, 2.7, -2.4, 3.3};
  bool door_to_corridor_open = false;
  bool door_to_kitchen = false;
};
std::vector<Eigen::Vector3d> build_office(FurnitureKit* kit, const OfficePlan& plan);

}  // namespace dkp_slam
