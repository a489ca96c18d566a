#include "dkp_slam/synth/figure/figure_look.h"

#include <algorithm>
#include <array>

namespace dkp_slam {
namespace {

template <std::size_t n>
const cv::Scalar& pick(cv::RNG& rng, const std::array<cv::Scalar, n>& colours) {
  return colours[static_cast<std::size_t>(rng.uniform(0, static_cast<int>(n)))];
}

cv::Scalar varied(cv::RNG& rng, const cv::Scalar& colour, double share) {
  return colour * rng.uniform(1.0 - share, 1.0 + share);
}

// Of people in photographs, in sRGB.
const std::array<cv::Scalar, 6> skins = {
    cv::Scalar(165, 185, 228), {150, 172, 218}, {132, 158, 210},
    {105, 138, 190},           {80, 110, 160},  {62, 85, 128}};
const std::array<cv::Scalar, 6> hairs = {cv::Scalar(28, 28, 32), {32, 42, 58},   {40, 58, 88},
                                         {58, 92, 132},          {95, 140, 180}, {35, 40, 48}};
const std::array<cv::Scalar, 9> tops = {
    cv::Scalar(190, 192, 195), {60, 45, 40}, {125, 75, 45},  {55, 50, 150}, {75, 95, 60},
    {120, 120, 122},           {45, 45, 48}, {165, 135, 95}, {95, 85, 160}};
const std::array<cv::Scalar, 5> trousers = {
    cv::Scalar(110, 75, 50), {85, 58, 42}, {52, 50, 50}, {85, 105, 125}, {140, 105, 75}};
const std::array<cv::Scalar, 4> shoes = {
    cv::Scalar(40, 40, 44), {45, 60, 88}, {185, 185, 188}, {95, 85, 80}};

}  // namespace

FigureLook random_look(std::uint64_t seed) {
  cv::RNG rng(seed * 0x9E3779B97F4A7C15ULL + 0x632BE59BD9B4E019ULL);
  for (int i = 0; i < 4; ++i) rng.next();  // neighbouring seeds start alike
  FigureLook look;
  look.woman = rng.uniform(0, 2) == 1;
  // The sum of three is about normal: few are very tall.
  const double tall = rng.uniform(-1.0, 1.0) + rng.uniform(-1.0, 1.0) + rng.uniform(-1.0, 1.0);
  look.height = std::clamp((look.woman ? 1.67 : 1.79) + 0.06 * tall, 1.55, 1.95);
  look.build = (look.woman ? 0.94 : 1.0) * rng.uniform(0.93, 1.12);
  look.shoulders = look.woman ? rng.uniform(0.86, 0.93) : rng.uniform(0.96, 1.06);
  look.stride = rng.uniform(0.94, 1.06);
  look.swing = rng.uniform(0.8, 1.2);
  look.skin = varied(rng, pick(rng, skins), 0.05);
  look.hair = varied(rng, pick(rng, hairs), 0.15);
  look.top_colour = varied(rng, pick(rng, tops), 0.15);
  do {
    look.second_colour = varied(rng, pick(rng, tops), 0.15);
  } while (cv::norm(look.second_colour - look.top_colour) < 60.0);
  look.trousers_colour = varied(rng, pick(rng, trousers), 0.15);
  look.shoe_colour = varied(rng, pick(rng, shoes), 0.15);
  look.top = static_cast<FigureLook::Top>(rng.uniform(0, 4));
  look.cloth = static_cast<FigureLook::Cloth>(rng.uniform(0, 4));
  if (look.top == FigureLook::Top::jacket) look.cloth = FigureLook::Cloth::plain;
  look.hair_cut = look.woman ? static_cast<FigureLook::HairCut>(rng.uniform(1, 3))
                             : FigureLook::HairCut::short_hair;
  look.beard = !look.woman && rng.uniform(0, 3) == 0;
  look.tucked = (look.top == FigureLook::Top::t_shirt || look.top == FigureLook::Top::shirt) &&
                rng.uniform(0, 2) == 0;
  look.texture_seed = rng.next();
  look.motion_seed = rng.next();
  return look;
}

}  // namespace dkp_slam
