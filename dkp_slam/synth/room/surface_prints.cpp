#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/synth/mesh/patterns.h"
#include "dkp_slam/synth/room/prints.h"

namespace dkp_slam {
namespace {

cv::Scalar tinted(cv::RNG& rng, const cv::Scalar& colour, double spread) {
  return colour * rng.uniform(1.0 - spread, 1.0 + spread);
}

/// Independent noise of each texel, `amplitude` grey levels.
void add_grains(cv::RNG& rng, cv::Mat* image, double amplitude) {
  cv::Mat noise(image->size(), CV_16SC1);
  rng.fill(noise, cv::RNG::UNIFORM, -amplitude, amplitude + 1.0);
  for (int y = 0; y < image->rows; ++y) {
    auto* pixel = image->ptr<cv::Vec3b>(y);
    const auto* n = noise.ptr<std::int16_t>(y);
    for (int x = 0; x < image->cols; ++x) {
      for (int c = 0; c < 3; ++c) pixel[x][c] = cv::saturate_cast<std::uint8_t>(pixel[x][c] + n[x]);
    }
  }
}

cv::Point somewhere(cv::RNG& rng, const cv::Size& size) {
  const int x = rng.uniform(0, size.width);
  return {x, rng.uniform(0, size.height)};
}

}  // namespace

cv::Mat plaster_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double metre) {
  cv::Mat image = plain_image(size, colour);
  const double area = size.width / metre * size.height / metre;
  // Scuffs, filled holes and drips of paint: what the eye only sees on a second look.
  for (int i = 0; i < cvRound(26.0 * area); ++i) {
    const cv::Point at = somewhere(rng, size);
    const int r = cvRound(metre * rng.uniform(0.004, 0.018));
    const cv::Scalar mark = colour * rng.uniform(0.84, 1.04);
    cv::ellipse(image, at, {r + 1, r / 3 + 1}, rng.uniform(0.0, 180.0), 0, 360, mark, cv::FILLED,
                cv::LINE_AA);
  }
  for (int i = 0; i < cvRound(3.0 * area); ++i) {
    const cv::Point at = somewhere(rng, size);
    const int dx = cvRound(metre * rng.uniform(-0.2, 0.2));
    const int dy = cvRound(metre * rng.uniform(-0.1, 0.1));
    cv::line(image, at, at + cv::Point(dx, dy), colour * rng.uniform(0.80, 0.93), 1, cv::LINE_AA);
  }
  add_octaves(rng, &image, 4.0, {size.width / 120 + 1, size.height / 120 + 1});
  return image;
}

cv::Mat wallpaper_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double metre) {
  cv::Mat image = plain_image(size, colour);
  const cv::Scalar stripe = tinted(rng, colour, 0.08), leaf = colour * rng.uniform(0.66, 0.80);
  const int step = cvRound(0.26 * metre);
  for (int x = 0; x < size.width; x += step) {
    cv::rectangle(image, cv::Rect(x, 0, step / 2, size.height), stripe, cv::FILLED);
    for (int y = (x / step % 2) * step / 2; y < size.height; y += step) {
      // A sprig; hand-printed, so that no two are the same.
      const cv::Point root(x + step / 4 + rng.uniform(-3, 4), y + step / 2 + rng.uniform(-4, 5));
      const int leaves = rng.uniform(3, 6);
      for (int i = 0; i < leaves; ++i) {
        const double angle = rng.uniform(-2.6, -0.5);
        const int r = cvRound(metre * rng.uniform(0.018, 0.040));
        const cv::Point tip(root.x + cvRound(r * std::cos(angle)),
                            root.y + cvRound(r * std::sin(angle)));
        cv::ellipse(image, tip, {r / 2 + 1, r / 5 + 1}, angle * 57.3, 0, 360,
                    tinted(rng, leaf, 0.15), cv::FILLED, cv::LINE_AA);
        cv::line(image, root, tip, leaf, 1, cv::LINE_AA);
      }
    }
  }
  add_octaves(rng, &image, 3.0, {size.width / 100 + 1, size.height / 100 + 1});
  return image;
}

cv::Mat carpet_tiles_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double metre) {
  cv::Mat image = plain_image(size, colour);
  const int tile = cvRound(0.5 * metre);
  for (int y = 0; y < size.height; y += tile) {
    for (int x = 0; x < size.width; x += tile) {
      const cv::Rect box = cv::Rect(x, y, tile, tile) & cv::Rect(cv::Point(), size);
      cv::Mat part = image(box);
      part.setTo(tinted(rng, colour, 0.10));
      // Broken stripes, turned by a quarter from tile to tile.
      const bool upright = (x / tile + y / tile) % 2 == 0;
      for (int i = 0; i < 30; ++i) {
        const int along = rng.uniform(0, tile), across = rng.uniform(0, tile);
        const int length = rng.uniform(tile / 12, tile / 3), width = rng.uniform(2, 5);
        const cv::Scalar yarn =
            colour * (rng.uniform(0, 4) == 0 ? rng.uniform(1.35, 1.7) : rng.uniform(0.6, 0.85));
        cv::rectangle(part,
                      upright ? cv::Rect(across, along, width, length)
                              : cv::Rect(along, across, length, width),
                      yarn, cv::FILLED);
      }
      cv::rectangle(image, cv::Rect(x, y, tile, tile), colour * 0.72, 1);
    }
  }
  add_grains(rng, &image, 9.0);
  return image;
}

cv::Mat parquet_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double metre) {
  cv::Mat image = plain_image(size, colour);
  const int width = cvRound(0.12 * metre);
  const cv::Mat grain = grain_print(rng, {size.width / 2, size.height / 2}, cv::Scalar::all(128));
  cv::Mat wide;
  cv::resize(grain, wide, size, 0, 0, cv::INTER_LINEAR);
  for (int y = 0; y < size.height; y += width) {
    for (int x = -rng.uniform(0, cvRound(metre)); x < size.width;) {
      const int length = cvRound(metre * rng.uniform(0.5, 1.2));
      const cv::Rect plank = cv::Rect(x, y, length, width) & cv::Rect(cv::Point(), size);
      x += length;
      if (plank.empty()) continue;
      image(plank).setTo(tinted(rng, colour, 0.15));
      cv::rectangle(image, plank, colour * 0.5, 1);
      if (rng.uniform(0, 3) == 0) {
        cv::ellipse(image, plank.tl() + somewhere(rng, plank.size()),
                    {rng.uniform(2, 6), rng.uniform(1, 4)}, 0, 0, 360, colour * 0.5, cv::FILLED,
                    cv::LINE_AA);
      }
    }
  }
  cv::Mat sum;
  cv::addWeighted(image, 1.0, wide, 0.8, -0.8 * 128.0, sum);
  return sum;
}

cv::Mat tiles_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double side,
                    double metre) {
  cv::Mat image = plain_image(size, colour * 0.72);
  const int tile = cvRound(side * metre);
  for (int y = 0; y < size.height; y += tile) {
    for (int x = 0; x < size.width; x += tile) {
      const cv::Rect box = cv::Rect(x + 1, y + 1, tile - 2, tile - 2);
      cv::rectangle(image, box, tinted(rng, colour, 0.07), cv::FILLED);
      if (rng.uniform(0, 9) != 0) continue;
      const cv::Point middle(x + tile / 2, y + tile / 2);
      const cv::Scalar ink = room_colour(rng, 60, 150);
      for (int k = 0; k < 4; ++k) {
        cv::ellipse(image, middle, {tile * 2 / 5, tile / 9}, 45.0 * k + rng.uniform(-6.0, 6.0), 0,
                    360, ink, 1 + tile / 60, cv::LINE_AA);
      }
      cv::circle(image, middle, tile / 9, room_colour(rng), cv::FILLED, cv::LINE_AA);
    }
  }
  add_octaves(rng, &image, 2.5, {size.width / 100 + 1, size.height / 100 + 1});
  return image;
}

cv::Mat rug_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, room_colour(rng, 50, 120));
  const int border = size.height / 12;
  for (int ring = 0; ring < 3; ++ring) {
    const int inset = border * ring;
    cv::rectangle(image, cv::Rect(inset, inset, size.width - 2 * inset, size.height - 2 * inset),
                  room_colour(rng, 40, 190), border / 3);
  }
  const int cell = size.height / 7;
  const cv::Scalar inks[3] = {room_colour(rng, 120, 210), room_colour(rng, 40, 110),
                              room_colour(rng, 60, 180)};
  for (int y = 3 * border; y + cell < size.height - 2 * border; y += cell) {
    for (int x = 3 * border; x + cell < size.width - 2 * border; x += cell) {
      const cv::Point m(x + cell / 2 + rng.uniform(-2, 3), y + cell / 2 + rng.uniform(-2, 3));
      const int r = cell * rng.uniform(30, 46) / 100;
      const cv::Point diamond[4] = {m + cv::Point(r, 0), m + cv::Point(0, r), m - cv::Point(r, 0),
                                    m - cv::Point(0, r)};
      cv::fillConvexPoly(image, diamond, 4, inks[rng.uniform(0, 3)], cv::LINE_AA);
      cv::circle(image, m, r / 3, inks[rng.uniform(0, 3)], cv::FILLED, cv::LINE_AA);
    }
  }
  add_grains(rng, &image, 10.0);
  return image;
}

cv::Mat grain_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour) {
  cv::Mat image = plain_image(size, colour);
  add_octaves(rng, &image, 13.0, {2, std::max(size.height / 16, 2)});
  for (int i = 0; i < size.area() / 20000 + 1; ++i) {
    const cv::Point at = somewhere(rng, size);
    const int r = rng.uniform(2, 7);
    for (int ring = 3; ring > 0; --ring) {
      cv::ellipse(image, at, {r * ring, r * ring / 2 + 1}, 0, 0, 360,
                  colour * (ring == 1 ? 0.55 : 0.85), ring == 1 ? cv::FILLED : 1, cv::LINE_AA);
    }
  }
  return image;
}

cv::Mat weave_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour) {
  cv::Mat image = plain_image(size, colour);
  for (int y = 0; y < size.height; ++y) {
    auto* pixel = image.ptr<cv::Vec3b>(y);
    for (int x = 0; x < size.width; ++x) {
      const double thread = (x / 2 + y / 2) % 2 == 0 ? 1.10 : 0.90;
      for (int c = 0; c < 3; ++c) pixel[x][c] = cv::saturate_cast<std::uint8_t>(colour[c] * thread);
    }
  }
  add_octaves(rng, &image, 6.0, {6, 6});
  for (int i = 0; i < size.area() / 6000 + 1; ++i) {  // fluff and small stains
    cv::circle(image, somewhere(rng, size), rng.uniform(1, 4), tinted(rng, colour, 0.35),
               cv::FILLED, cv::LINE_AA);
  }
  return image;
}

cv::Mat smooth_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour) {
  cv::Mat image = plain_image(size, colour);
  add_octaves(rng, &image, 3.0, {3, 3});
  for (int i = 0; i < size.area() / 9000 + 1; ++i) {  // scratches
    const cv::Point at = somewhere(rng, size);
    const int dx = rng.uniform(-12, 13), dy = rng.uniform(-6, 7);
    cv::line(image, at, at + cv::Point(dx, dy), tinted(rng, colour, 0.22), 1, cv::LINE_AA);
  }
  return image;
}

cv::Mat ceiling_print(cv::RNG& rng, cv::Size size, double metre) {
  const cv::Scalar white(226, 230, 232);
  cv::Mat image = plain_image(size, white);
  const int tile = cvRound(0.6 * metre);
  for (int i = 0; i < cvRound(size.area() / (metre * metre) * 420.0); ++i) {  // pin holes
    cv::circle(image, somewhere(rng, size), rng.uniform(0, 2), white * rng.uniform(0.72, 0.9),
               cv::FILLED, cv::LINE_AA);
  }
  for (int i = 0; i < std::max(size.width, size.height); i += tile) {
    cv::line(image, {i, 0}, {i, size.height}, white * 0.66, 2);
    cv::line(image, {0, i}, {size.width, i}, white * 0.66, 2);
  }
  return image;
}

cv::Mat leaf_print(cv::RNG& rng, cv::Size size) {
  const cv::Scalar green(rng.uniform(35, 60), rng.uniform(95, 135), rng.uniform(45, 80));
  cv::Mat image = plain_image(size, green);
  const cv::Scalar vein = green * 1.45;
  cv::line(image, {0, size.height / 2}, {size.width, size.height / 2}, vein, 2, cv::LINE_AA);
  for (int x = 0; x < size.width; x += size.width / 9 + 1) {
    cv::line(image, {x, size.height / 2}, {x + size.width / 7, 0}, vein, 1, cv::LINE_AA);
    cv::line(image, {x, size.height / 2}, {x + size.width / 7, size.height}, vein, 1, cv::LINE_AA);
  }
  add_octaves(rng, &image, 9.0, {4, 4});
  return image;
}

}  // namespace dkp_slam
