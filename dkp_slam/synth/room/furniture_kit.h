#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/synth/mesh/mesh.h"

namespace dkp_slam {

/// Something that parts are cut from: a square print of so many metres a side.
struct Material {
  TexturePtr texture;
  double metres = 1.0;
};

/// Builds furniture out of blocks, cushions, turned parts and pictures. Metres, z up.
class FurnitureKit {
 public:
  explicit FurnitureKit(cv::RNG& rng) : rng(rng) {}

  Material wood(const cv::Scalar& colour);
  Material cloth(const cv::Scalar& colour);
  Material smooth(const cv::Scalar& colour);

  /// An upright box; each side is cut from another place of the material, its grain lengthwise.
  void block(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, const Material& material,
             double yaw = 0.0);
  /// A box with edges rounded by `radius`.
  void cushion(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, double radius,
               const Material& material);
  /// A flat picture whose top left corner, seen from the side it shows, is `corner`.
  void picture(const Eigen::Vector3d& corner, const Eigen::Vector3d& right,
               const Eigen::Vector3d& down, TexturePtr print, float glow = 0.0F);
  /// A turned part that stands at `foot`: `profile` as of `lathe_mesh`, from top to bottom.
  void turned(const Eigen::Vector3d& foot, const std::vector<Eigen::Vector2d>& profile, int sides,
              const Material& material);
  void add(Mesh mesh) { meshes.push_back(std::move(mesh)); }
  /// Another piece, `foot` its origin, turned by `yaw` around z.
  void place(const std::vector<Mesh>& piece, const Eigen::Vector3d& foot, double yaw = 0.0);

  cv::RNG& rng;
  std::vector<Mesh> meshes;
};

TexturePtr make_texture(const cv::Mat& print);
/// A turn by `yaw` around z, then to `foot`.
Se3 standing(const Eigen::Vector3d& foot, double yaw);

/// Smaller things, around their origin as furniture is.
std::vector<Mesh> keyboard_and_mouse(cv::RNG& rng);
std::vector<Mesh> mug(cv::RNG& rng);
std::vector<Mesh> desk_lamp(cv::RNG& rng);
std::vector<Mesh> stack_of_papers(cv::RNG& rng);
std::vector<Mesh> waste_bin(cv::RNG& rng);
std::vector<Mesh> cupboard(cv::RNG& rng, const Eigen::Vector3d& size, const cv::Scalar& colour,
                           int columns, int rows);
std::vector<Mesh> table(cv::RNG& rng, double width, double depth, double height);
std::vector<Mesh> plain_chair(cv::RNG& rng);
std::vector<Mesh> floor_lamp(cv::RNG& rng);
/// A row of books of that width, their spines towards -y, on z = 0.
std::vector<Mesh> book_row(cv::RNG& rng, double width, double height, double depth);

}  // namespace dkp_slam
