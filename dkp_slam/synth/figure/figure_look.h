#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace dkp_slam {

/// What a figure looks like and how it moves, drawn from its seed. Colours are BGR, 0 to 255.
struct FigureLook {
  enum class Top { t_shirt, pullover, shirt, jacket };
  enum class Cloth { plain, striped, plaid, print };
  enum class HairCut { short_hair, bob, long_hair };

  bool woman = false;
  double height = 1.75;    ///< metres
  double build = 1.0;      ///< of the trunk's and limbs' girth; 1: average
  double shoulders = 1.0;  ///< width; 1: that of an average man
  double stride = 1.0;     ///< length of the steps; 1: as the height suggests
  double swing = 1.0;      ///< of the arms
  cv::Scalar skin, hair, top_colour, second_colour, trousers_colour, shoe_colour;
  Top top = Top::pullover;
  Cloth cloth = Cloth::plain;
  HairCut hair_cut = HairCut::short_hair;
  bool beard = false;
  bool tucked = false;  ///< the shirt into the trousers: the belt shows
  std::uint64_t texture_seed = 0;
  std::uint64_t motion_seed = 0;

  bool long_sleeves() const { return top != Top::t_shirt; }
};

FigureLook random_look(std::uint64_t seed);

}  // namespace dkp_slam
