#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "dkp_slam/synth/figure/figure_body.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

constexpr double chin = 1.522;  // metres above the floor
constexpr double crown = 1.750;
constexpr double head_ahead = 0.012;  // the head's axis ahead of the figure's
constexpr double frontal = 0.45;      // more columns in the face than on the back of the head
constexpr int columns = 40;

double gauss(double value, double sigma) { return std::exp(-0.5 * value * value / sigma / sigma); }

/// Heights from the chin. Skull and jaw without features, down to the neck.
std::vector<Section> head_sections(const FigureLook& look) {
  std::vector<Section> s = {
      {0.2280, .003, .003, .003, 2.0, -.008}, {0.2255, .026, .030, .034, 2.0, -.008},
      {0.2160, .046, .054, .062, 2.0, -.004}, {0.2000, .061, .072, .084, 2.1, 0.0},
      {0.1750, .072, .087, .100, 2.2, 0.0},   {0.1500, .075, .092, .104, 2.3, 0.0},
      {0.1250, .073, .091, .101, 2.4, 0.0},   {0.1000, .070, .089, .093, 2.3, 0.0},
      {0.0750, .066, .088, .080, 2.3, 0.0},   {0.0500, .060, .088, .068, 2.2, 0.0},
      {0.0250, .053, .085, .060, 2.1, 0.0},   {0.0080, .050, .078, .058, 2.0, 0.0},
      {-.0040, .050, .060, .058, 2.0, -.002}, {-.0160, .050, .046, .058, 2.0, -.004},
      {-.0400, .051, .044, .058, 2.0, -.010}, {-.0800, .056, .048, .062, 2.0, -.018}};
  for (Section& row : s) {
    const double neck = smooth_step(row.along, 0.02, -0.01);
    const double girth = look.woman ? 0.96 - 0.10 * neck : 1.0 + 0.06 * neck;
    row.side *= girth;
    row.front *= girth;
    row.back *= girth;
  }
  return s;
}

/// Adds nose, eye sockets, brows, lips, chin and cheeks.
Vector3d with_features(const FigureLook& look, double angle, const Vector3d& p) {
  const double z = p.z(), side = std::abs(angle);
  double out = 0.0;
  // The bridge runs down from between the eyes and ends in a tip.
  const double bridge = smooth_step(z, 0.132, 0.080) * smooth_step(z, 0.062, 0.078);
  out += (0.024 * gauss(angle, 0.10) + 0.008 * gauss(side - 0.16, 0.07)) * bridge;
  out += 0.004 * gauss(angle, 0.12) * gauss(z - 0.125, 0.012);
  out -= 0.007 * gauss(side - 0.36, 0.15) * gauss(z - 0.116, 0.011);
  out += (look.woman ? 0.002 : 0.004) * gauss(side - 0.3, 0.25) * gauss(z - 0.138, 0.009);
  out += 0.005 * gauss(angle, 0.20) * (gauss(z - 0.054, 0.005) + gauss(z - 0.043, 0.005));
  out += 0.006 * gauss(angle, 0.22) * gauss(z - 0.014, 0.013);
  out -= 0.003 * gauss(angle, 0.3) * gauss(z - 0.030, 0.006);
  out += 0.004 * gauss(side - 0.75, 0.2) * gauss(z - 0.088, 0.014);
  return p + Vector3d(out, 0.0, 0.0);
}

Influence head_influence(double z) {
  return Influence::of(Joint::neck, Joint::head, smooth_step(z, 1.49, 1.555));
}

SkinnedMesh ear(int side) {
  SkinnedMesh skin;
  skin.mesh = ellipsoid_mesh({0.019, 0.009, 0.032}, 10, nullptr);
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(-0.15, Vector3d::UnitY()) *
                                Eigen::AngleAxisd(0.35 * side, Vector3d::UnitZ()));
  skin.mesh = Se3(tilt, {head_ahead - 0.008, 0.073 * side, chin + 0.098}) * skin.mesh;
  // The skin in front of the ear, a little darker in its hollows.
  for (Eigen::Vector2f& uv : skin.mesh.uv) {
    uv = {0.5F + 0.27F * static_cast<float>(side) + 0.03F * (uv.x() - 0.5F),
          0.5F + 0.05F * (uv.y() - 0.5F)};
  }
  skin.influences.assign(skin.mesh.rest.vertices.size(), Influence::of(Joint::head));
  return skin;
}

/// How far down from the crown hair grows, metres above the chin, at an angle from the front.
double hair_line(const FigureLook& look, double angle) {
  const double a = std::abs(angle);
  const double front = 0.188 - 0.012 * gauss(a, 0.25);
  if (look.hair_cut == FigureLook::HairCut::short_hair) {
    const double temple = front + (0.105 - front) * smooth_step(a, 0.65, 1.3);
    const double above_ear = temple + (0.128 - temple) * smooth_step(a, 1.35, 1.5);
    return above_ear + (0.015 - above_ear) * smooth_step(a, 1.75, 2.3);
  }
  const double length = look.hair_cut == FigureLook::HairCut::bob ? 0.01 : -0.16;
  const double temple = front + (0.10 - front) * smooth_step(a, 0.7, 1.05);
  return temple + (length - temple) * smooth_step(a, 1.0, 1.35);
}

/// A shell over the head from the crown to the hair line.
SkinnedMesh hair(const FigureLook& look) {
  constexpr int rows = 17;
  const std::vector<Section> sections = head_sections(look);
  const bool is_short = look.hair_cut == FigureLook::HairCut::short_hair;
  const double thickness = is_short ? 0.013 : 0.020;
  const double phase = static_cast<double>(look.texture_seed % 97);
  SkinnedMesh skin;
  for (int r = 0; r < rows; ++r) {
    const double q = static_cast<double>(r) / (rows - 1);
    for (int c = 0; c <= columns; ++c) {
      const double u = static_cast<double>(c) / columns;
      const double angle = loft_angle(c == columns ? 0.0 : u, frontal);
      // Rows lie closer at the crown, which curves most.
      const double z = 0.228 + (hair_line(look, angle) - 0.228) * std::pow(q, 1.6);
      // Below the widest part hair hangs straight.
      const double hanging = is_short ? 0.035 : 0.115;
      Section section = section_at(sections, std::max(z, hanging));
      Vector3d p = section_point(section, angle);
      // And gathers towards its end.
      const double taper = 1.0 - 0.16 * smooth_step(z, hanging, -0.16);
      p = {taper * p.x(), taper * p.y(), z};
      const double edge = smooth_step(q, 1.0, is_short ? 0.8 : 0.9);
      const double strands = 1.0 + 0.16 * std::sin(9.0 * angle + phase + 14.0 * q) +
                             0.10 * std::sin(23.0 * angle + 2.0 * phase);
      const double off = 0.002 + thickness * strands * (0.25 + 0.75 * edge);
      const double up = smooth_step(z, 0.15, 0.228);
      const Vector3d outwards(std::cos(angle), std::sin(angle), 0.0);
      p += off * ((1.0 - 0.75 * up) * outwards + up * Vector3d::UnitZ());
      p += Vector3d(head_ahead, 0.0, chin);
      skin.mesh.rest.vertices.push_back(p.cast<float>());
      skin.mesh.uv.emplace_back(static_cast<float>(u), static_cast<float>(q));
      // Long hair lies on the shoulders.
      skin.influences.push_back(
          Influence::of(Joint::chest, Joint::head, smooth_step(p.z(), 1.36, 1.54)));
    }
  }
  add_grid_triangles(skin.mesh, rows, columns);
  compute_grid_normals(skin.mesh, rows, columns);
  return skin;
}

}  // namespace

std::vector<SkinnedMesh> figure_head(const FigureLook& look, const FigureTextures& textures) {
  LoftShape shape;
  shape.sections = head_sections(look);
  shape.rows = 38;
  shape.sides = columns;
  shape.frontal = frontal;
  SkinnedMesh head = loft(
      shape, {Eigen::Quaterniond::Identity(), Vector3d(head_ahead, 0.0, chin)},
      [](const Vector3d& p) { return head_influence(p.z()); },
      [&](double angle, const Vector3d& p) { return with_features(look, angle, p); });
  for (const int side : {1, -1}) append(ear(side), head);
  head.mesh.texture = textures.head;
  SkinnedMesh cap = hair(look);
  cap.mesh.texture = textures.hair;
  return {std::move(head), std::move(cap)};
}

}  // namespace dkp_slam
