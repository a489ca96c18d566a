#include "dkp_slam/synth/figure/figure_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

const Se3 in_place;

Se3 shifted(double x, double y, double z) {
  return {Eigen::Quaterniond::Identity(), Vector3d(x, y, z)};
}

/// Girths times `factor`.
std::vector<Section> scaled(std::vector<Section> sections, double factor) {
  for (Section& s : sections) {
    s.side *= factor;
    s.front *= factor;
    s.back *= factor;
  }
  return sections;
}

Influence trunk_influence(const Vector3d& p, double shoulders) {
  const double z = p.z();
  if (z < 1.12) return Influence::of(Joint::pelvis, Joint::spine, smooth_step(z, 0.98, 1.12));
  if (z < 1.28) return Influence::of(Joint::spine, Joint::chest, smooth_step(z, 1.12, 1.28));
  Influence influence = Influence::of(Joint::chest, Joint::neck, 0.6 * smooth_step(z, 1.46, 1.54));
  // The cloth over the shoulder goes with the arm a little.
  const double arm = 0.35 * smooth_step(std::abs(p.y()), 0.12 * shoulders, 0.185 * shoulders) *
                     smooth_step(z, 1.30, 1.40);
  influence.joints[2] = of_side(Joint::left_upper_arm, p.y() > 0.0 ? 1 : -1);
  influence.weights[0] -= static_cast<float>(arm) * influence.weights[0];
  influence.weights[1] -= static_cast<float>(arm) * influence.weights[1];
  influence.weights[2] = static_cast<float>(arm);
  return influence;
}

/// Uneven cloth: metres that it stands off, from a few waves that differ between figures.
double folds(const Vector3d& p, double phase) {
  const double a = std::atan2(p.y(), p.x());
  return 0.5 * std::sin(3.0 * a + 9.0 * p.z() + phase) +
         0.3 * std::sin(7.0 * a - 17.0 * p.z() + 2.0 * phase) +
         0.3 * std::sin(2.0 * a + 38.0 * p.z() + 3.0 * phase);
}

/// Women's waists are narrower, by this share of the side and a little more in front.
double waist(const FigureLook& look, double z) {
  return look.woman ? std::exp(-std::pow((z - 1.12) / 0.08, 2.0)) : 0.0;
}

std::vector<Section> trunk_sections(const FigureLook& look) {
  std::vector<Section> sections = {{1.535, .058, .048, .062, 2.0}, {1.515, .062, .053, .068, 2.0},
                                   {1.496, .088, .064, .078, 2.1}, {1.477, .130, .078, .090, 2.2},
                                   {1.455, .168, .092, .100, 2.3}, {1.415, .186, .108, .110, 2.5},
                                   {1.360, .184, .121, .114, 2.6}, {1.300, .178, .127, .112, 2.5},
                                   {1.220, .166, .120, .103, 2.4}, {1.140, .159, .114, .096, 2.3}};
  const std::vector<Section> hanging = {{1.060, .162, .115, .100, 2.3},
                                        {0.980, .174, .120, .120, 2.3},
                                        {0.920, .186, .126, .140, 2.4},
                                        {0.885, .187, .126, .141, 2.4},
                                        {0.880, .170, .110, .125, 2.4}};
  const std::vector<Section> inside = {{1.075, .160, .116, .100, 2.3},
                                       {1.062, .158, .114, .098, 2.3},
                                       {1.045, .138, .094, .082, 2.3},
                                       {0.980, .130, .085, .080, 2.3}};
  const std::vector<Section>& hem = look.tucked ? inside : hanging;
  sections.insert(sections.end(), hem.begin(), hem.end());
  for (Section& s : sections) {
    s.shift = -0.012;
    const double above = smooth_step(s.along, 1.16, 1.30);
    const double girth =
        s.along > 1.47 ? 1.0 : look.build * (look.top == FigureLook::Top::jacket ? 1.06 : 1.0);
    s.side *=
        (above * look.shoulders + (1.0 - above)) * (1.0 - 0.10 * waist(look, s.along)) * girth;
    s.front *= (1.0 - 0.12 * waist(look, s.along)) * girth;
    s.back *= girth;
  }
  return sections;
}

SkinnedMesh trunk(const FigureLook& look) {
  LoftShape shape;
  shape.sections = trunk_sections(look);
  shape.rows = 30;
  shape.sides = 28;
  const double phase = static_cast<double>(look.texture_seed % 628) / 100.0;
  const auto bump = [&](double, const Vector3d& p) -> Vector3d {
    Vector3d moved = p;
    const double loose = 0.006 * smooth_step(-p.z(), -1.38, -1.2) * folds(p, phase);
    const Vector3d outwards = Vector3d(p.x() + 0.012, p.y(), 0.0).normalized();
    moved += loose * outwards;
    if (p.x() > 0.0) {
      if (look.woman) {
        const double dz = (p.z() - 1.275) / 0.055, dy = (std::abs(p.y()) - 0.075) / 0.05;
        moved.x() += 0.038 * std::exp(-dz * dz - dy * dy);
      }
      const double belly = std::max(look.build - 0.98, 0.0);
      const double dz = (p.z() - 1.05) / 0.11, dy = p.y() / 0.12;
      moved.x() += 0.35 * belly * std::exp(-dz * dz - dy * dy);
    } else {
      // Between the shoulder blades.
      const double dz = (p.z() - 1.33) / 0.1, dy = p.y() / 0.025;
      moved.x() += 0.008 * std::exp(-dz * dz - dy * dy);
    }
    return moved;
  };
  return loft(
      shape, in_place, [&](const Vector3d& p) { return trunk_influence(p, look.shoulders); }, bump);
}

Influence arm_influence(int side, double z) {
  const Joint upper = of_side(Joint::left_upper_arm, side);
  const Joint lower = of_side(Joint::left_forearm, side);
  return Influence::of(upper, lower, smooth_step(-z, -1.185, -1.075));
}

/// A sleeve's crumples around the elbow and above the cuff.
double sleeve_folds(const Vector3d& p, double phase) {
  const double a = std::atan2(p.y(), p.x());
  const double elbow = std::exp(-std::pow((p.z() - 1.13) / 0.07, 2.0));
  const double cuff = std::exp(-std::pow((p.z() - 0.93) / 0.05, 2.0));
  return (elbow + cuff) * std::sin(2.0 * a + 130.0 * p.z() + phase);
}

SkinnedMesh sleeve(const FigureLook& look, int side) {
  LoftShape shape;
  shape.sections = {{1.474, .004, .004, .004, 2.0}, {1.470, .022, .024, .024, 2.0},
                    {1.456, .037, .042, .042, 2.0}, {1.430, .049, .056, .056, 2.0},
                    {1.385, .053, .060, .060, 2.1}, {1.330, .051, .056, .056, 2.0}};
  if (look.long_sleeves()) {
    const std::vector<Section> rest = {
        {1.250, .047, .050, .050, 2.0}, {1.180, .044, .046, .047, 2.0},
        {1.130, .043, .044, .047, 2.0}, {1.080, .044, .046, .045, 2.0},
        {1.000, .041, .043, .041, 2.0}, {0.930, .036, .038, .036, 2.0},
        {0.900, .035, .036, .035, 2.0}, {0.885, .034, .035, .034, 2.0},
        {0.872, .033, .035, .033, 2.0}, {0.870, .022, .024, .022, 2.0}};
    shape.sections.insert(shape.sections.end(), rest.begin(), rest.end());
  } else {
    const std::vector<Section> rest = {{1.265, .053, .057, .057, 2.0},
                                       {1.215, .056, .060, .060, 2.0},
                                       {1.212, .046, .050, .050, 2.0}};
    shape.sections.insert(shape.sections.end(), rest.begin(), rest.end());
  }
  const bool thick = look.top == FigureLook::Top::jacket || look.top == FigureLook::Top::pullover;
  shape.sections = scaled(shape.sections, look.build * (thick ? 1.06 : 1.0));
  shape.rows = look.long_sleeves() ? 30 : 14;
  shape.sides = 14;
  const double phase = static_cast<double>(look.texture_seed % 314) / 50.0 + side;
  return loft(
      shape, shifted(-0.01, 0.185 * look.shoulders * side, 0.0),
      [&](const Vector3d& p) { return arm_influence(side, p.z()); },
      [&](double, const Vector3d& p) -> Vector3d {
        const double stand_off = look.long_sleeves() ? 1.0 + 0.07 * sleeve_folds(p, phase) : 1.0;
        // The shoulder slopes: its top lies nearer to the neck.
        const double inwards = 0.55 * std::max(p.z() - 1.37, 0.0);
        return {stand_off * p.x(), stand_off * p.y() - side * inwards, p.z()};
      });
}

SkinnedMesh bare_arm(const FigureLook& look, int side) {
  LoftShape shape;
  shape.sections = {{1.300, .030, .030, .030, 2.0}, {1.280, .044, .047, .047, 2.0},
                    {1.200, .040, .045, .043, 2.0}, {1.130, .038, .039, .040, 2.0},
                    {1.070, .041, .043, .039, 2.0}, {0.980, .034, .037, .034, 2.0},
                    {0.900, .024, .029, .028, 2.0}, {0.865, .021, .027, .027, 2.0}};
  shape.sections = scaled(shape.sections, look.woman ? 0.86 * look.build : look.build);
  shape.rows = 16;
  shape.sides = 12;
  return loft(shape, shifted(-0.01, 0.185 * look.shoulders * side, 0.0),
              [&](const Vector3d& p) { return arm_influence(side, p.z()); });
}

SkinnedMesh pelvis(const FigureLook& look) {
  LoftShape shape;
  shape.sections = {{1.080, .150, .106, .090, 2.3}, {1.030, .154, .107, .100, 2.3},
                    {0.980, .162, .108, .114, 2.4}, {0.920, .169, .108, .124, 2.5},
                    {0.870, .169, .102, .120, 2.5}, {0.835, .150, .086, .105, 2.4},
                    {0.805, .100, .060, .075, 2.2}, {0.785, .020, .015, .020, 2.0}};
  shape.sections = scaled(shape.sections, look.build);
  for (Section& s : shape.sections) {
    s.shift = -0.01;
    // Under a shirt that hangs over it the band must not show.
    const double hidden = look.tucked ? 1.02 : 1.0 - 0.16 * smooth_step(s.along, 0.96, 1.04);
    s.side *= hidden * (1.0 - 0.10 * waist(look, s.along));
    s.front *= hidden * (1.0 - 0.12 * waist(look, s.along));
    s.back *= hidden;
  }
  shape.rows = 13;
  shape.sides = 20;
  return loft(shape, in_place, [](const Vector3d&) { return Influence::of(Joint::pelvis); });
}

SkinnedMesh leg(const FigureLook& look, int side) {
  LoftShape shape;
  shape.sections = {{1.005, .010, .010, .010, 2.0, -.010}, {0.995, .040, .040, .045, 2.0, -.010},
                    {0.965, .068, .068, .085, 2.0, -.010}, {0.915, .084, .086, .104, 2.1, -.008},
                    {0.850, .086, .090, .100, 2.1, -.004}, {0.740, .080, .086, .084, 2.1, .002},
                    {0.620, .070, .074, .070, 2.0, .006},  {0.540, .063, .066, .060, 2.0, .008},
                    {0.485, .060, .064, .056, 2.0, .006},  {0.420, .058, .058, .060, 2.0, .000},
                    {0.340, .058, .054, .068, 2.0, -.004}, {0.240, .055, .052, .060, 2.0, -.006},
                    {0.140, .053, .054, .056, 2.0, -.004}, {0.075, .056, .062, .058, 2.0, .000},
                    {0.040, .057, .066, .058, 2.0, .002},  {0.038, .045, .050, .045, 2.0, .002}};
  for (Section& s : shape.sections) {
    // Trousers hide how stout a calf is.
    const double girth = 1.0 + (look.build - 1.0) * smooth_step(s.along, 0.3, 0.8);
    s.side *= girth;
    s.front *= girth;
    s.back *= girth;
  }
  shape.rows = 31;
  shape.sides = 16;
  const double phase = static_cast<double>(look.texture_seed % 419) / 60.0 + side;
  const Joint thigh = of_side(Joint::left_thigh, side), shin = of_side(Joint::left_shin, side);
  return loft(
      shape, shifted(0.0, 0.09 * side, 0.0),
      [&](const Vector3d& p) {
        return Influence::of(thigh, shin, smooth_step(-p.z(), -0.56, -0.41));
      },
      [&](double, const Vector3d& p) -> Vector3d {
        const double a = std::atan2(p.y(), p.x());
        const double knee = std::exp(-std::pow((p.z() - 0.48) / 0.08, 2.0));
        const double hem = smooth_step(-p.z(), -0.22, -0.08);
        const double fold = std::sin(2.0 * a + 80.0 * p.z() + phase);
        const double stand_off = 1.0 + (0.035 * knee + 0.07 * hem) * fold;
        return {stand_off * p.x(), stand_off * p.y(), p.z()};
      });
}

SkinnedMesh shoe(int side) {
  // The loft runs from the heel to the toes; up is its front, the sole its back.
  LoftShape shape;
  shape.sections = {{.088, .010, .010, .010, 2.0, .038},  {.084, .026, .028, .034, 2.4, .036},
                    {.065, .036, .055, .040, 3.0, .040},  {.030, .038, .068, .040, 3.0, .040},
                    {-.020, .038, .058, .040, 3.0, .040}, {-.060, .041, .036, .040, 3.0, .040},
                    {-.110, .047, .022, .040, 3.0, .040}, {-.150, .045, .012, .040, 3.0, .040},
                    {-.180, .036, .010, .034, 2.8, .036}, {-.196, .022, .012, .024, 2.4, .030},
                    {-.203, .004, .004, .004, 2.0, .026}};
  shape.rows = 17;
  shape.sides = 12;
  Eigen::Matrix3d axes;
  axes << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  const Joint foot = of_side(Joint::left_foot, side), toes = of_side(Joint::left_toes, side);
  return loft(shape, {Eigen::Quaterniond(axes), Vector3d(0.0, 0.09 * side, 0.0)},
              [&](const Vector3d& p) {
                return Influence::of(foot, toes, smooth_step(p.x(), 0.095, 0.15));
              });
}

SkinnedMesh with_texture(SkinnedMesh mesh, TexturePtr texture) {
  mesh.mesh.texture = std::move(texture);
  return mesh;
}

}  // namespace

std::vector<SkinnedMesh> figure_body(const FigureLook& look, const FigureTextures& textures) {
  std::vector<SkinnedMesh> meshes;
  meshes.push_back(with_texture(trunk(look), textures.trunk));
  SkinnedMesh sleeves, legs, shoes, skin = figure_hands(look);
  for (const int side : {1, -1}) {
    append(sleeve(look, side), sleeves);
    append(leg(look, side), legs);
    append(shoe(side), shoes);
    if (!look.long_sleeves()) append(bare_arm(look, side), skin);
  }
  meshes.push_back(with_texture(std::move(sleeves), textures.sleeves));
  meshes.push_back(with_texture(pelvis(look), textures.pelvis));
  meshes.push_back(with_texture(std::move(legs), textures.legs));
  meshes.push_back(with_texture(std::move(shoes), textures.shoes));
  meshes.push_back(with_texture(std::move(skin), textures.skin));
  for (SkinnedMesh& mesh : figure_head(look, textures)) meshes.push_back(std::move(mesh));
  const auto scale = static_cast<float>(look.height / reference_height);
  for (SkinnedMesh& mesh : meshes) {
    for (Eigen::Vector3f& v : mesh.mesh.rest.vertices) v *= scale;
  }
  return meshes;
}

std::vector<MeshPose> skinned(const std::vector<SkinnedMesh>& meshes,
                              const PerJoint<Vector3d>& rest, const JointPoses& joints) {
  using Transform = Eigen::Matrix<float, 3, 4>;
  PerJoint<Transform> transforms;
  for (std::size_t j = 0; j < joint_count; ++j) {
    const Eigen::Matrix3d rotation = joints.at(j).rotation.toRotationMatrix();
    transforms.at(j).leftCols<3>() = rotation.cast<float>();
    transforms.at(j).col(3) = (joints.at(j).translation - rotation * rest.at(j)).cast<float>();
  }
  std::vector<MeshPose> posed(meshes.size());
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const MeshPose& from = meshes[m].mesh.rest;
    const std::size_t count = from.vertices.size();
    posed[m].vertices.resize(count);
    posed[m].normals.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const Influence& influence = meshes[m].influences[i];
      Transform blend = influence.weights[0] * transforms[influence.joints[0]];
      for (std::size_t k = 1; k < 3; ++k) {
        if (influence.weights[k] > 0.0F) {
          blend += influence.weights[k] * transforms[influence.joints[k]];
        }
      }
      posed[m].vertices[i] = blend.leftCols<3>() * from.vertices[i] + blend.col(3);
      posed[m].normals[i] = (blend.leftCols<3>() * from.normals[i]).normalized();
    }
  }
  return posed;
}

}  // namespace dkp_slam
