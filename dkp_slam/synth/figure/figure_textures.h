#pragma once

#include "dkp_slam/synth/figure/figure_look.h"
#include "dkp_slam/synth/mesh/texture.h"

#include <memory>

namespace dkp_slam {

/// The painted surfaces of a figure, as the lofts of figure_body.h unroll them: once around, the
/// front in the middle column, the top in the first row.
struct FigureTextures {
  std::shared_ptr<const Texture> trunk, sleeves, pelvis, legs, shoes, head, hair, skin;
};

/// Same look, same bytes.
FigureTextures paint_figure(const FigureLook& look);

}  // namespace dkp_slam
