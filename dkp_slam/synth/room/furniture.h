#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/synth/mesh/mesh.h"

namespace dkp_slam {

/// Furniture, each standing on the floor around its own origin, front towards -y, z up, metres.
/// Colours and prints come from `rng`: same state, same bytes.
std::vector<Mesh> desk(cv::RNG& rng, double width = 1.6, double depth = 0.8);
std::vector<Mesh> office_chair(cv::RNG& rng);
/// Without its drawers.
std::vector<Mesh> drawer_cabinet(cv::RNG& rng);
/// One drawer of `drawer_cabinet`, closed, in the cabinet's frame; it opens along -y.
std::vector<Mesh> cabinet_drawer(cv::RNG& rng, int index);
std::vector<Mesh> book_shelf(cv::RNG& rng, double width = 1.0, double height = 1.9);
std::vector<Mesh> monitor(cv::RNG& rng);
std::vector<Mesh> cardboard_box(cv::RNG& rng, const Eigen::Vector3d& size);
std::vector<Mesh> potted_plant(cv::RNG& rng);
std::vector<Mesh> sofa(cv::RNG& rng);

/// A furnished place: what stands still in it.
struct Place {
  std::vector<Mesh> meshes;
  std::vector<Eigen::Vector3d> lamps;  ///< under the ceiling
};

/// An office: the origin on the floor, x right, y ahead to the desk at about y = 2, walls at
/// x = -2.7 and 2.7, y = -2.4 and 3.3, ceiling at 2.7.
Place office(cv::RNG& rng);
/// A flat of several rooms with open doors around which a loop of about 25 m can be walked; its
/// first room is the office.
Place flat(cv::RNG& rng);
/// Way points (x, y) of that loop, closed, in the order of the walk, metres.
std::vector<Eigen::Vector2d> flat_loop();

}  // namespace dkp_slam
