#include "dkp_slam/synth/mesh/patterns.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

/// Half as saturated as three random channels would be: rooms are not candy shops.
cv::Scalar random_colour(cv::RNG& rng, int darkest = 50, int brightest = 215) {
  const double grey = rng.uniform(darkest, brightest);
  cv::Scalar colour;
  for (int c = 0; c < 3; ++c) colour[c] = 0.5 * (grey + rng.uniform(darkest, brightest));
  return colour;
}

std::string random_text(cv::RNG& rng, int letters) {
  std::string text;
  for (int i = 0; i < letters; ++i) {
    text += rng.uniform(0, 6) == 0 ? ' ' : static_cast<char>('A' + rng.uniform(0, 26));
  }
  return text;
}

/// A line of text that fills `box`' height; cut off at its right edge.
void put_text(cv::RNG& rng, cv::Mat* image, const cv::Rect& box, const cv::Scalar& colour) {
  constexpr double letter_height = 22.0;  // pixels of this font at scale 1
  const double scale = box.height / letter_height * 0.7;
  const int letters = std::max(static_cast<int>(box.width / (18.0 * scale)), 1);
  cv::Mat part = (*image)(box & cv::Rect(cv::Point(), image->size()));
  if (part.empty()) return;
  cv::putText(part, random_text(rng, letters), cv::Point(1, box.height * 4 / 5),
              cv::FONT_HERSHEY_SIMPLEX, scale, colour, box.height > 24 ? 2 : 1, cv::LINE_AA);
}

}  // namespace

void add_octaves(cv::RNG& rng, cv::Mat* image, double amplitude, cv::Size coarsest_cells) {
  constexpr int octaves = 5;
  constexpr double persistence = 0.7;
  cv::Mat sum = cv::Mat::zeros(image->size(), CV_32F);
  cv::Size cells = coarsest_cells;
  double strength = amplitude;
  for (int i = 0; i < octaves; ++i) {
    const cv::Size grid(std::min(cells.width, image->cols), std::min(cells.height, image->rows));
    cv::Mat coarse(grid, CV_32F), fine;
    rng.fill(coarse, cv::RNG::UNIFORM, -1.0, 1.0);
    cv::resize(coarse, fine, image->size(), 0, 0, cv::INTER_CUBIC);
    cv::scaleAdd(fine, strength, sum, sum);
    strength *= persistence;
    cells.width *= 2;
    cells.height *= 2;
  }
  for (int y = 0; y < image->rows; ++y) {
    const auto* offset = sum.ptr<float>(y);
    auto* pixel = image->ptr<cv::Vec3b>(y);
    for (int x = 0; x < image->cols; ++x) {
      const int grey = cvRound(offset[x]);
      for (int c = 0; c < 3; ++c) pixel[x][c] = cv::saturate_cast<std::uint8_t>(pixel[x][c] + grey);
    }
  }
}

cv::Mat plain_image(cv::Size size, const cv::Scalar& colour) {
  cv::Mat image(size, CV_8UC3);
  image.setTo(colour);
  return image;
}

cv::Mat paint_pattern(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double roughness) {
  cv::Mat image = plain_image(size, colour);
  add_octaves(rng, &image, roughness, {size.width / 64 + 1, size.height / 64 + 1});
  return image;
}

cv::Mat wood_pattern(cv::RNG& rng, cv::Size size, const cv::Scalar& colour) {
  cv::Mat image = plain_image(size, colour);
  add_octaves(rng, &image, 16.0, {3, std::max(size.height / 24, 2)});
  // Knots and joints.
  for (int i = 0; i < std::max(size.area() / 30000, 2); ++i) {
    const cv::Point at(rng.uniform(0, size.width), rng.uniform(0, size.height));
    cv::ellipse(image, at, cv::Size(rng.uniform(4, 14), rng.uniform(2, 6)), 0, 0, 360,
                colour * rng.uniform(0.45, 0.75), cv::FILLED, cv::LINE_AA);
  }
  return image;
}

cv::Mat carpet_pattern(cv::RNG& rng, cv::Size size, const cv::Scalar& colour) {
  cv::Mat image = plain_image(size, colour);
  constexpr int tile = 110;
  for (int y = 0; y < size.height; y += tile) {
    for (int x = 0; x < size.width; x += tile) {
      const cv::Scalar tint = colour * rng.uniform(0.75, 1.25);
      cv::rectangle(image, cv::Rect(x + 3, y + 3, tile - 6, tile - 6), tint, cv::FILLED);
      const cv::Point centre(x + rng.uniform(25, tile - 25), y + rng.uniform(25, tile - 25));
      const int r = rng.uniform(6, 22);
      cv::rectangle(image, cv::Rect(centre.x - r, centre.y - r / 2, 2 * r, r),
                    colour * rng.uniform(0.5, 1.5), cv::FILLED, cv::LINE_AA);
    }
  }
  add_octaves(rng, &image, 12.0, {size.width / 40 + 1, size.height / 40 + 1});
  return image;
}

cv::Mat checks_pattern(cv::RNG& rng, cv::Size size, int cell) {
  const cv::Scalar light = random_colour(rng, 150, 215), dark = random_colour(rng, 50, 110);
  cv::Mat image(size, CV_8UC3);
  for (int y = 0; y < size.height; y += cell) {
    for (int x = 0; x < size.width; x += cell) {
      const bool odd = (x / cell + y / cell) % 2 == 1;
      cv::rectangle(image, cv::Rect(x, y, cell, cell),
                    (odd ? light : dark) * rng.uniform(0.75, 1.2), cv::FILLED);
    }
  }
  add_octaves(rng, &image, 6.0);
  return image;
}

cv::Mat poster_pattern(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, random_colour(rng, 110, 205));
  add_octaves(rng, &image, 14.0, {3, 3});
  const int shapes = rng.uniform(14, 26);
  const int largest = std::max(std::min(size.width, size.height) / 4, 8);
  for (int i = 0; i < shapes; ++i) {
    const cv::Point at(rng.uniform(0, size.width), rng.uniform(0, size.height));
    const int r = rng.uniform(largest / 6 + 2, largest);
    const cv::Scalar colour = random_colour(rng);
    const int kind = rng.uniform(0, 4);
    if (kind == 0) {
      cv::circle(image, at, r / 2, colour, cv::FILLED, cv::LINE_AA);
    } else if (kind == 1) {
      const cv::RotatedRect box(at, cv::Size2f(static_cast<float>(r), 0.7F * r),
                                rng.uniform(0.0F, 90.0F));
      cv::Point2f corners[4];
      box.points(corners);
      const std::vector<cv::Point> polygon(corners, corners + 4);
      cv::fillConvexPoly(image, polygon, colour, cv::LINE_AA);
    } else if (kind == 2) {
      const std::vector<cv::Point> triangle = {at, at + cv::Point(r, rng.uniform(-r, r)),
                                               at + cv::Point(rng.uniform(-r, r), r)};
      cv::fillConvexPoly(image, triangle, colour, cv::LINE_AA);
    } else {
      put_text(rng, &image, cv::Rect(at.x, at.y, 2 * r + 10, std::max(r / 3, 9)), colour);
    }
  }
  put_text(rng, &image, cv::Rect(8, 8, size.width - 16, std::max(size.height / 8, 10)),
           random_colour(rng, 30, 90));
  cv::rectangle(image, cv::Rect(0, 0, size.width, size.height), random_colour(rng, 40, 100), 4);
  return image;
}

cv::Mat books_pattern(cv::RNG& rng, cv::Size size, int shelf_height) {
  cv::Mat image = plain_image(size, cv::Scalar(52, 58, 66));
  constexpr int board = 8;
  for (int shelf = 0; shelf + shelf_height / 2 < size.height; shelf += shelf_height) {
    const int bottom = std::min(shelf + shelf_height - board, size.height);
    for (int x = 2; x < size.width;) {
      const int width = rng.uniform(9, 24);
      const int height = static_cast<int>((shelf_height - board) * rng.uniform(0.62, 0.92));
      if (rng.uniform(0, 9) != 0) {
        const cv::Rect back(x, bottom - height, width - 1, height);
        const cv::Scalar colour = random_colour(rng);
        cv::rectangle(image, back, colour, cv::FILLED);
        cv::rectangle(image, back, colour * 0.6, 1);
        const int label = rng.uniform(height / 8, height / 2);
        cv::rectangle(image, cv::Rect(x + 2, back.y + label, width - 5, height / 6),
                      random_colour(rng, 120, 215), cv::FILLED);
        cv::rectangle(image, cv::Rect(x + 2, back.y + height * 4 / 5, width - 5, 4), colour * 1.4,
                      cv::FILLED);
      }
      x += width;
    }
    cv::rectangle(image, cv::Rect(0, bottom, size.width, board), cv::Scalar(90, 130, 165),
                  cv::FILLED);
  }
  add_octaves(rng, &image, 5.0);
  return image;
}

cv::Mat screen_pattern(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, cv::Scalar(120, 95, 70));
  add_octaves(rng, &image, 14.0, {3, 2});
  for (int window = 0; window < 3; ++window) {
    const cv::Rect box(rng.uniform(4, size.width / 2), rng.uniform(4, size.height / 2),
                       size.width * 2 / 5, size.height * 2 / 5);
    cv::rectangle(image, box, cv::Scalar(205, 205, 200), cv::FILLED);
    cv::rectangle(image, cv::Rect(box.x, box.y, box.width, 10), random_colour(rng, 60, 140),
                  cv::FILLED);
    for (int y = box.y + 14; y + 10 < box.br().y; y += 10) {
      put_text(rng, &image, cv::Rect(box.x + 4, y, rng.uniform(box.width / 3, box.width - 6), 10),
               random_colour(rng, 20, 110));
    }
  }
  cv::rectangle(image, cv::Rect(0, 0, size.width, size.height), cv::Scalar(45, 45, 48), 8);
  return image;
}

cv::Mat cloth_pattern(cv::RNG& rng, cv::Size size, const cv::Scalar& colour) {
  cv::Mat image = plain_image(size, colour);
  // Stripes at divisors of the width close around the limb.
  const int cell = size.width / (8 << rng.uniform(0, 2));
  for (int x = 0; x < size.width; x += cell) {
    cv::rectangle(image, cv::Rect(x, 0, cell / 3, size.height), colour * 0.72, cv::FILLED);
  }
  for (int y = 0; y < size.height; y += cell) {
    cv::rectangle(image, cv::Rect(0, y, size.width, cell / 4), colour * 1.3, cv::FILLED);
  }
  for (int i = 0; i < 14; ++i) {
    const int w = rng.uniform(size.width / 24, size.width / 8);
    const cv::Point at(rng.uniform(0, size.width - w), rng.uniform(0, size.height - w));
    cv::rectangle(image, cv::Rect(at.x, at.y, w, w * 2 / 3), random_colour(rng), cv::FILLED);
    put_text(rng, &image, cv::Rect(at.x, at.y, w, std::max(w / 2, 6)), random_colour(rng, 20, 90));
  }
  add_octaves(rng, &image, 9.0);
  return image;
}

cv::Mat head_pattern(cv::RNG& rng, cv::Size size, const cv::Scalar& skin, const cv::Scalar& hair) {
  cv::Mat image = plain_image(size, skin);
  const int w = size.width, h = size.height;
  const auto ellipse = [&](int dx, double y, double rx, double ry, const cv::Scalar& colour) {
    cv::ellipse(image, cv::Point(w / 2 + dx, static_cast<int>(y * h)),
                cv::Size(static_cast<int>(rx * w), static_cast<int>(ry * h)), 0, 0, 360, colour,
                cv::FILLED, cv::LINE_AA);
  };
  for (const int side : {-1, 1}) {
    ellipse(side * w / 17, 0.44, 0.022, 0.018, {235, 235, 235});
    ellipse(side * w / 17, 0.44, 0.010, 0.016, {40, 45, 60});
    ellipse(side * w / 17, 0.385, 0.035, 0.012, hair);
  }
  ellipse(0, 0.54, 0.016, 0.05, skin * 0.85);
  ellipse(0, 0.66, 0.042, 0.016, {85, 80, 165});
  cv::rectangle(image, cv::Rect(0, 0, w, h * 27 / 100), hair, cv::FILLED);
  for (const int x : {0, w * 72 / 100}) {
    cv::rectangle(image, cv::Rect(x, 0, w * 28 / 100, h * 68 / 100), hair, cv::FILLED);
  }
  add_octaves(rng, &image, 7.0);
  return image;
}

void add_wrapped_octaves(cv::RNG& rng, cv::Mat* image, double amplitude, cv::Size coarsest_cells) {
  cv::Mat noise(image->size(), CV_8UC3, cv::Scalar::all(128)), mirrored, mixed;
  add_octaves(rng, &noise, amplitude, coarsest_cells);
  // Towards the right edge it becomes its mirror image, which ends as the left edge starts.
  cv::flip(noise, mirrored, 1);
  const int first = noise.cols * 3 / 4;
  for (int x = first; x < noise.cols; ++x) {
    const double share = static_cast<double>(x - first) / (noise.cols - first);
    cv::addWeighted(noise.col(x), 1.0 - share, mirrored.col(x), share, 0.0, mixed);
    mixed.copyTo(noise.col(x));
  }
  cv::Mat sum;
  cv::add(*image, noise, sum, cv::noArray(), CV_16S);
  sum.convertTo(*image, CV_8U, 1.0, -128.0);
}

}  // namespace dkp_slam
