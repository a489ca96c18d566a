#pragma once

#include <vector>

#include "dkp_slam/synth/figure/figure_loft.h"
#include "dkp_slam/synth/figure/figure_look.h"
#include "dkp_slam/synth/figure/figure_textures.h"

namespace dkp_slam {

/// The clothed body in the rest pose of `rest_joints`, each mesh with its texture, metres. Cross
/// sections after the proportions of adults (Drillis and Contini 1966; NASA-STD-3000, §3).
std::vector<SkinnedMesh> figure_body(const FigureLook& look, const FigureTextures& textures);

/// Head with neck, and hair, for `figure_body`; reference measures (not yet scaled).
std::vector<SkinnedMesh> figure_head(const FigureLook& look, const FigureTextures& textures);

/// Both hands, for `figure_body`; reference measures.
SkinnedMesh figure_hands(const FigureLook& look);

/// The meshes' vertices and normals when the joints are in these poses.
std::vector<MeshPose> skinned(const std::vector<SkinnedMesh>& meshes,
                              const PerJoint<Eigen::Vector3d>& rest, const JointPoses& joints);

}  // namespace dkp_slam
