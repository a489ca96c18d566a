#include "dkp_slam/synth/figure/figure_textures.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/synth/figure/figure_face.h"
#include "dkp_slam/synth/mesh/patterns.h"

namespace dkp_slam {
namespace {

using Cloth = FigureLook::Cloth;

/// Light and shade as shares of the colour, in soft strokes; laid over a painting at the end.
class Shading {
 public:
  explicit Shading(cv::Size size) : field_(cv::Mat::zeros(size, CV_32F)) {}

  /// A fold: dark on one side, light on the other.
  void fold(const cv::Point2d& from, const cv::Point2d& to, double width, double depth) {
    const cv::Point2d along = to - from;
    const double length = std::max(std::hypot(along.x, along.y), 1e-6);
    const cv::Point2d aside = cv::Point2d(-along.y, along.x) * (0.45 * width / length);
    stroke(from + aside, to + aside, width, -depth);
    stroke(from - aside, to - aside, width, 0.7 * depth);
  }

  void stroke(const cv::Point2d& from, const cv::Point2d& to, double width, double depth) {
    const double sigma = 0.6 * width;
    // 99% of the bell; what lies beyond is no grey level, but half of the work.
    const int reach = cvCeil(2.5 * sigma);
    const int margin = cvRound(0.5 * width) + reach + 1;
    for (const int shift : {-1, 0, 1}) {  // both copies across the seam
      const cv::Point2d by(shift * field_.cols, 0);
      const cv::Rect bounds = cv::Rect(cv::Rect2d(from + by, to + by));
      const cv::Rect around(bounds.x - margin, bounds.y - margin, bounds.width + 2 * margin,
                            bounds.height + 2 * margin);
      const cv::Rect box = around & cv::Rect(cv::Point(), field_.size());
      if (box.empty()) continue;
      cv::Mat layer = cv::Mat::zeros(around.size(), CV_32F);
      const cv::Point2d origin = around.tl();
      cv::line(layer, from + by - origin, to + by - origin, cv::Scalar(depth),
               std::max(cvRound(width), 1), cv::LINE_8);
      cv::GaussianBlur(layer, layer, cv::Size(2 * reach + 1, 2 * reach + 1), sigma, sigma,
                       cv::BORDER_REPLICATE);
      field_(box) += layer(box - around.tl());
    }
  }

  void put_on(cv::Mat& image) const {
    for (int y = 0; y < image.rows; ++y) {
      const auto* shade = field_.ptr<float>(y);
      auto* pixel = image.ptr<cv::Vec3b>(y);
      for (int x = 0; x < image.cols; ++x) {
        const float factor = std::clamp(1.0F + shade[x], 0.25F, 1.8F);
        for (int c = 0; c < 3; ++c) {
          pixel[x][c] = cv::saturate_cast<unsigned char>(pixel[x][c] * factor);
        }
      }
    }
  }

 private:
  cv::Mat field_;
};

/// Cloth; `repeats` of the pattern go around.
cv::Mat cloth(cv::RNG& rng, cv::Size size, const FigureLook& look, int repeats) {
  cv::Mat image = plain_image(size, look.top_colour);
  const int cell = std::max(size.width / repeats, 4);
  const auto band = [&](bool upright, int at, int width, double share) {
    const cv::Rect box =
        upright ? cv::Rect(at, 0, width, size.height) : cv::Rect(0, at, size.width, width);
    cv::Mat part = image(box & cv::Rect(cv::Point(), size));
    if (part.empty()) return;
    part = part * (1.0 - share) + look.second_colour * share;
  };
  if (look.cloth == Cloth::striped) {
    for (int y = 0; y < size.height; y += cell) band(false, y, cell * 2 / 5, 1.0);
  } else if (look.cloth == Cloth::plaid) {
    for (int x = 0; x < size.width; x += cell) {
      band(true, x, cell * 2 / 5, 0.55);
      band(true, x + cell * 7 / 10, std::max(cell / 12, 1), 0.8);
    }
    for (int y = 0; y < size.height; y += cell) {
      band(false, y, cell * 2 / 5, 0.55);
      band(false, y + cell * 7 / 10, std::max(cell / 12, 1), 0.8);
    }
  }
  add_wrapped_octaves(rng, &image, 5.0, {4, 4});
  return image;
}

void buttons(cv::Mat& image, const cv::Scalar& colour, double top, double bottom, double x) {
  for (int i = 0; i < 7; ++i) {
    const double y = top + (bottom - top) * i / 6.0;
    cv::circle(image, cv::Point(cvRound(x * image.cols), cvRound(y * image.rows)), 4, colour * 0.6,
               cv::FILLED, cv::LINE_AA);
    cv::circle(image, cv::Point(cvRound(x * image.cols), cvRound(y * image.rows)), 3, colour,
               cv::FILLED, cv::LINE_AA);
  }
}

void fill(cv::Mat& image, const std::vector<cv::Point2d>& corners, const cv::Scalar& colour) {
  std::vector<cv::Point> polygon;
  for (const cv::Point2d& c : corners) {
    polygon.emplace_back(cvRound(c.x * image.cols), cvRound(c.y * image.rows));
  }
  cv::fillPoly(image, std::vector<std::vector<cv::Point>>{polygon}, colour, cv::LINE_AA);
}

/// What a front shows: collar, buttons, a jacket's opening, a print.
void dress_front(cv::RNG& rng, cv::Mat& image, const FigureLook& look) {
  const int w = image.cols, h = image.rows;
  const cv::Scalar dark = look.top_colour * 0.6;
  if (look.top == FigureLook::Top::shirt) {
    fill(image, {{.488, .02}, {.512, .02}, {.5, .11}}, look.skin * 0.9);
    fill(image, {{.44, .03}, {.492, .03}, {.5, .10}, {.475, .13}}, look.top_colour * 1.15);
    fill(image, {{.56, .03}, {.508, .03}, {.5, .10}, {.525, .13}}, look.top_colour * 1.15);
    cv::line(image, {cvRound(.486 * w), cvRound(.13 * h)}, {cvRound(.486 * w), h}, dark, 1,
             cv::LINE_AA);
    cv::line(image, {cvRound(.514 * w), cvRound(.10 * h)}, {cvRound(.514 * w), h}, dark, 1,
             cv::LINE_AA);
    buttons(image, {215, 215, 215}, 0.15, 0.93, 0.5);
    cv::rectangle(image, cv::Rect(w * 56 / 100, h * 30 / 100, w * 8 / 100, h * 13 / 100), dark, 1,
                  cv::LINE_AA);
  } else if (look.top == FigureLook::Top::jacket) {
    fill(image, {{.45, .0}, {.55, .0}, {.535, .62}, {.56, 1.0}, {.44, 1.0}, {.465, .62}},
         look.second_colour);
    fill(image, {{.48, .0}, {.52, .0}, {.5, .09}}, look.skin * 0.9);
    for (const double side : {-1.0, 1.0}) {
      const auto x = [&](double from_middle) { return 0.5 + side * from_middle; };
      fill(image, {{x(.05), .0}, {x(.095), .16}, {x(.07), .20}, {x(.038), .58}, {x(.045), .2}},
           look.top_colour * 1.25);
      cv::line(image, {cvRound(x(.06) * w), cvRound(.7 * h)},
               {cvRound(x(.14) * w), cvRound(.7 * h)}, dark, 3, cv::LINE_AA);
    }
  } else {
    fill(image, {{.44, .0}, {.56, .0}, {.53, .06}, {.5, .08}, {.47, .06}}, look.skin * 0.92);
    cv::ellipse(image, cv::Point(w / 2, 0), cv::Size(w * 7 / 100, h * 9 / 100), 0, 0, 180, dark, 4,
                cv::LINE_AA);
  }
  if (look.cloth == Cloth::print && look.top != FigureLook::Top::shirt) {
    const cv::Rect box(w * 42 / 100, h * 26 / 100, w * 16 / 100, h * 22 / 100);
    cv::Mat picture = poster_pattern(rng, cv::Size(4 * box.width, 4 * box.height)), small;
    cv::resize(picture, small, box.size(), 0, 0, cv::INTER_AREA);
    small.copyTo(image(box));
  }
}

/// Creases of a shirt: from the armpits, above the hem, down the back.
void crease_trunk(cv::RNG& rng, cv::Mat& image) {
  const double w = image.cols, h = image.rows;
  Shading shading(image.size());
  for (const double side : {0.25, 0.75}) {
    // Under the arms no lamp shines.
    shading.stroke({side * w, 0.22 * h}, {side * w, 1.0 * h}, 0.10 * w, -0.22);
    for (int i = 0; i < 6; ++i) {
      const double towards = i % 2 == 0 ? 1.0 : -1.0;
      const cv::Point2d from((side + towards * rng.uniform(0.03, 0.06)) * w,
                             rng.uniform(0.24, 0.40) * h);
      const cv::Point2d by(towards * rng.uniform(0.04, 0.11) * w, rng.uniform(-0.02, 0.16) * h);
      shading.fold(from, from + by, rng.uniform(0.010, 0.022) * w, rng.uniform(0.10, 0.24));
    }
  }
  for (int i = 0; i < 16; ++i) {
    const cv::Point2d from(rng.uniform(0.0, 1.0) * w, rng.uniform(0.50, 0.95) * h);
    const cv::Point2d by(rng.uniform(-0.14, 0.14) * w, rng.uniform(-0.05, 0.10) * h);
    shading.fold(from, from + by, rng.uniform(0.008, 0.024) * w, rng.uniform(0.08, 0.22));
  }
  shading.stroke({0.0, h}, {w, h}, 0.03 * h, -0.35);
  shading.put_on(image);
}

cv::Mat paint_trunk(cv::RNG& rng, const FigureLook& look) {
  cv::Mat image = cloth(rng, {1024, 768}, look, 16);
  dress_front(rng, image, look);
  // The collar.
  cv::rectangle(image, cv::Rect(0, 0, image.cols * 45 / 100, 46), look.top_colour * 0.85,
                cv::FILLED);
  cv::rectangle(image, cv::Rect(image.cols * 55 / 100, 0, image.cols, 46), look.top_colour * 0.85,
                cv::FILLED);
  crease_trunk(rng, image);
  return image;
}

cv::Mat paint_sleeves(cv::RNG& rng, const FigureLook& look) {
  cv::Mat image = cloth(rng, {256, 512}, look, 6);
  const double w = image.cols, h = image.rows;
  Shading shading(image.size());
  const double elbow = look.long_sleeves() ? 0.57 : 0.9;
  for (int i = 0; i < 12; ++i) {
    const cv::Point2d from(rng.uniform(0.0, 1.0) * w,
                           (elbow + (i < 8 ? rng.uniform(-0.14, 0.14) : 0.3)) * h);
    const cv::Point2d by(rng.uniform(0.15, 0.4) * w, rng.uniform(-0.05, 0.05) * h);
    shading.fold(from, from + by, rng.uniform(0.03, 0.08) * w, rng.uniform(0.12, 0.28));
  }
  // The inner side is in the arm's own shade; the seam at the shoulder.
  shading.stroke({0.0, 0.15 * h}, {0.0, h}, 0.2 * w, -0.12);
  shading.stroke({0.0, 0.07 * h}, {w, 0.07 * h}, 0.012 * h, -0.15);
  shading.stroke({0.0, 0.94 * h}, {w, 0.94 * h}, 0.012 * h, -0.30);
  shading.put_on(image);
  return image;
}

/// Trousers' cloth: denim is woven of blue and white threads.
cv::Mat denim(cv::RNG& rng, cv::Size size, const cv::Scalar& colour) {
  cv::Mat image = plain_image(size, colour);
  add_wrapped_octaves(rng, &image, 6.0, {6, 6});
  return image;
}

cv::Mat paint_pelvis(cv::RNG& rng, const FigureLook& look) {
  cv::Mat image = denim(rng, {512, 256}, look.trousers_colour);
  const int w = image.cols, h = image.rows;
  const cv::Scalar seam = look.trousers_colour * 0.6, belt(30, 36, 46);
  cv::rectangle(image, cv::Rect(0, h / 12, w, h / 7), belt, cv::FILLED);
  cv::rectangle(image, cv::Rect(w / 2 - 9, h / 14, 18, h / 6), cv::Scalar(170, 180, 185),
                cv::FILLED, cv::LINE_AA);
  for (int x = w / 16; x < w; x += w / 8) {
    cv::rectangle(image, cv::Rect(x, h / 16, 6, h / 5), seam, cv::FILLED);
  }
  cv::line(image, {w / 2, h / 4}, {w / 2, h * 8 / 10}, seam, 3, cv::LINE_AA);
  for (const int side : {-1, 1}) {
    cv::line(image, {w / 2 + side * w / 9, h / 4}, {w / 2 + side * w / 5, h * 6 / 10}, seam, 3,
             cv::LINE_AA);
    cv::rectangle(image, cv::Rect(w / 2 + side * w * 37 / 100 - w / 16, h * 35 / 100, w / 8, h / 3),
                  seam, 2, cv::LINE_AA);
  }
  return image;
}

cv::Mat paint_legs(cv::RNG& rng, const FigureLook& look) {
  cv::Mat image = denim(rng, {256, 1024}, look.trousers_colour);
  const double w = image.cols, h = image.rows;
  for (const double x : {0.25, 0.75}) {
    cv::line(image, {cvRound(x * w), 0}, {cvRound(x * w), image.rows}, look.trousers_colour * 0.65,
             2, cv::LINE_AA);
  }
  Shading shading(image.size());
  // Worn on the thighs; creases behind and around the knees, above the hem and at the hip.
  shading.stroke({0.5 * w, 0.15 * h}, {0.5 * w, 0.42 * h}, 0.16 * w, 0.22);
  shading.stroke({0.5 * w, 0.60 * h}, {0.5 * w, 0.85 * h}, 0.12 * w, 0.10);
  const auto creases = [&](double at, double spread, int count) {
    for (int i = 0; i < count; ++i) {
      const cv::Point2d from(rng.uniform(0.0, 1.0) * w, (at + rng.uniform(-spread, spread)) * h);
      const cv::Point2d by(rng.uniform(0.12, 0.4) * w, rng.uniform(-0.02, 0.02) * h);
      shading.fold(from, from + by, rng.uniform(0.03, 0.07) * w, rng.uniform(0.10, 0.26));
    }
  };
  creases(0.54, 0.06, 12);
  creases(0.92, 0.06, 14);
  creases(0.13, 0.04, 6);
  shading.put_on(image);
  return image;
}

cv::Mat paint_shoes(cv::RNG& rng, const FigureLook& look) {
  cv::Mat image(cv::Size(256, 256), CV_8UC3, look.shoe_colour);
  const int w = image.cols, h = image.rows;
  const bool dark = look.shoe_colour[1] < 70.0;
  const cv::Scalar sole = dark ? cv::Scalar(190, 195, 200) : cv::Scalar(60, 60, 62);
  cv::rectangle(image, cv::Rect(0, 0, w * 20 / 100, h), sole, cv::FILLED);
  cv::rectangle(image, cv::Rect(w * 80 / 100, 0, w * 20 / 100, h), sole, cv::FILLED);
  for (int i = 0; i < 5; ++i) {
    const int y = h * (38 + 6 * i) / 100;
    cv::line(image, {w * 43 / 100, y}, {w * 57 / 100, y + 4}, cv::Scalar(215, 215, 215), 4,
             cv::LINE_AA);
  }
  cv::line(image, {w * 2 / 10, h * 7 / 10}, {w * 8 / 10, h * 7 / 10}, look.shoe_colour * 0.6, 3,
           cv::LINE_AA);
  add_octaves(rng, &image, 5.0);
  return image;
}

std::shared_ptr<const Texture> wrapped(const cv::Mat& image) {
  return std::make_shared<const Texture>(image, true);
}

}  // namespace

FigureTextures paint_figure(const FigureLook& look) {
  cv::RNG rng(look.texture_seed);
  FigureTextures textures;
  textures.trunk = wrapped(paint_trunk(rng, look));
  textures.sleeves = wrapped(paint_sleeves(rng, look));
  textures.pelvis = wrapped(paint_pelvis(rng, look));
  textures.legs = wrapped(paint_legs(rng, look));
  textures.shoes = wrapped(paint_shoes(rng, look));
  textures.head = wrapped(paint_head(rng, look));
  textures.hair = wrapped(paint_hair(rng, look));
  textures.skin = wrapped(paint_skin(rng, look));
  return textures;
}

}  // namespace dkp_slam
