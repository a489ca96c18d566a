#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/synth/mesh/patterns.h"
#include "dkp_slam/synth/room/prints.h"

namespace dkp_slam {
namespace {

std::string made_up_words(cv::RNG& rng, int letters) {
  static const char* const syllables[] = {"ta",  "re",  "no", "mi",  "lu", "sen", "kor", "va",
                                          "dis", "pel", "an", "gri", "to", "ber", "ex",  "im"};
  std::string text;
  while (static_cast<int>(text.size()) < letters) {
    std::string word;
    const int parts = rng.uniform(1, 4);
    for (int i = 0; i < parts; ++i) word += syllables[rng.uniform(0, 16)];
    if (rng.uniform(0, 4) == 0) word[0] = static_cast<char>(word[0] - 'a' + 'A');
    text += word + (rng.uniform(0, 7) == 0 ? ", " : " ");
  }
  return text;
}

void fill_box(cv::Mat* image, int x, int y, int width, int height, const cv::Scalar& colour) {
  if (width > 0 && height > 0) {
    cv::rectangle(*image, cv::Rect(x, y, width, height), colour, cv::FILLED);
  }
}

/// A paragraph: lines of words, the last one short.
void write_lines(cv::RNG& rng, cv::Mat* image, const cv::Rect& box, int line,
                 const cv::Scalar& colour) {
  for (int y = box.y; y + line <= box.y + box.height; y += line * 3 / 2) {
    const int width = rng.uniform(box.width * 2 / 3, box.width + 1);
    write_words(rng, image, cv::Rect(box.x, y, width, line), colour);
  }
}

/// Mountains: a line that is displaced at ever finer steps.
std::vector<cv::Point> skyline(cv::RNG& rng, const cv::Size& size, int base, double roughness) {
  std::vector<double> heights = {rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)};
  for (double spread = 1.0; heights.size() < 64; spread *= 0.55) {
    std::vector<double> finer;
    for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
      finer.push_back(heights[i]);
      finer.push_back(0.5 * (heights[i] + heights[i + 1]) + spread * rng.uniform(-0.5, 0.5));
    }
    finer.push_back(heights.back());
    heights = finer;
  }
  std::vector<cv::Point> line = {{size.width, size.height}, {0, size.height}};
  for (std::size_t i = 0; i < heights.size(); ++i) {
    line.emplace_back(static_cast<int>(i) * size.width / static_cast<int>(heights.size() - 1),
                      base - cvRound(heights[i] * roughness));
  }
  return line;
}

cv::Mat abstract_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, room_colour(rng, 150, 235));
  const int columns = rng.uniform(3, 6), rows = std::max(columns * size.height / size.width, 2);
  const cv::Scalar inks[4] = {room_colour(rng, 20, 90), room_colour(rng, 40, 220),
                              room_colour(rng, 40, 220), room_colour(rng, 160, 240)};
  const int w = size.width / columns, h = size.height / rows;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      fill_box(&image, x * w, y * h, w, h, inks[rng.uniform(1, 4)]);
      const cv::Point m(x * w + w / 2, y * h + h / 2);
      const int kind = rng.uniform(0, 4), r = std::min(w, h) * rng.uniform(25, 50) / 100;
      const cv::Scalar& ink = inks[rng.uniform(0, 4)];
      if (kind == 0) {
        cv::circle(image, m, r, ink, cv::FILLED, cv::LINE_AA);
      } else if (kind == 1) {
        cv::ellipse(image, {x * w, y * h}, {w, h}, 0, 0, 90, ink, cv::FILLED, cv::LINE_AA);
      } else if (kind == 2) {
        const cv::Point t[3] = {{x * w, y * h + h}, {x * w + w, y * h + h}, {x * w + w, y * h}};
        cv::fillConvexPoly(image, t, 3, ink, cv::LINE_AA);
      }
    }
  }
  return image;
}

}  // namespace

cv::Scalar room_colour(cv::RNG& rng, int darkest, int brightest) {
  const double grey = rng.uniform(darkest, brightest);
  cv::Scalar colour;
  for (int c = 0; c < 3; ++c) colour[c] = 0.5 * (grey + rng.uniform(darkest, brightest));
  return colour;
}

void write_words(cv::RNG& rng, cv::Mat* image, const cv::Rect& box, const cv::Scalar& colour) {
  const double scale = box.height / 30.0;  // this font's letters with their tails are 30 high
  const int letters = std::max(static_cast<int>(box.width / (17.0 * scale)), 1);
  const std::string text = made_up_words(rng, letters).substr(0, static_cast<std::size_t>(letters));
  cv::Mat part = (*image)(box & cv::Rect(cv::Point(), image->size()));
  if (part.empty()) return;
  cv::putText(part, text, {0, box.height * 7 / 10}, cv::FONT_HERSHEY_SIMPLEX, scale, colour,
              std::max(cvRound(2.0 * scale), 1), cv::LINE_AA);
}

cv::Mat landscape_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image(size, CV_8UC3);
  const cv::Scalar top(rng.uniform(170, 225), rng.uniform(120, 170), rng.uniform(60, 130));
  const cv::Scalar low(rng.uniform(190, 235), rng.uniform(200, 235), rng.uniform(200, 245));
  for (int y = 0; y < size.height; ++y) {
    image.row(y).setTo(top + (low - top) * (static_cast<double>(y) / size.height));
  }
  add_octaves(rng, &image, 10.0, {2, 4});
  cv::circle(image, {rng.uniform(size.width / 5, size.width), size.height / 5}, size.height / 14,
             {200, 235, 250}, cv::FILLED, cv::LINE_AA);
  for (int range = 0; range < 4; ++range) {
    const double share = range / 3.0;
    const cv::Scalar far(160, 140, 125), near(30, 55, 40);
    const int base = size.height * (45 + 15 * range) / 100;
    const auto line = skyline(rng, size, base, size.height * 0.28);
    cv::fillPoly(image, std::vector<std::vector<cv::Point>>{line}, far + (near - far) * share,
                 cv::LINE_AA);
  }
  for (int i = 0; i < 70; ++i) {  // trees in front
    const int x = rng.uniform(0, size.width), y = rng.uniform(size.height * 3 / 4, size.height);
    const int r = std::max((y - size.height / 2) / 8, 2);
    const cv::Point tree[3] = {{x - r / 2, y}, {x + r / 2, y}, {x, y - 2 * r}};
    cv::fillConvexPoly(image, tree, 3, cv::Scalar(40, 70, 45) * rng.uniform(0.5, 1.7), cv::LINE_AA);
  }
  return image;
}

cv::Mat chart_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, cv::Scalar(238, 240, 242));
  const int w = size.width, h = size.height, line = std::max(h / 30, 8);
  fill_box(&image, 0, 0, w, h / 8, room_colour(rng, 40, 150));
  write_words(rng, &image, cv::Rect(w / 20, h / 40, w * 9 / 10, h / 12), {245, 245, 245});
  for (int panel = 0; panel < 4; ++panel) {
    const cv::Rect box(w / 20 + panel % 2 * (w / 2), h / 6 + panel / 2 * (h * 2 / 5), w * 2 / 5,
                       h / 3);
    const int kind = rng.uniform(0, 3);
    if (kind == 0) {
      write_lines(rng, &image, box, line, {60, 50, 50});
      continue;
    }
    cv::rectangle(image, box, {90, 90, 90}, 1);
    const cv::Scalar ink = room_colour(rng, 30, 190);
    cv::Point last(box.x, box.y + box.height / 2);
    for (int i = 0; i < 9; ++i) {
      const int x = box.x + box.width * i / 9;
      const int height = rng.uniform(box.height / 8, box.height * 9 / 10);
      if (kind == 1) {
        fill_box(&image, x + 2, box.y + box.height - height, box.width / 13, height, ink);
      } else {
        const cv::Point next(x + box.width / 9, box.y + box.height - height);
        cv::line(image, last, next, ink, std::max(w / 200, 1), cv::LINE_AA);
        cv::circle(image, next, std::max(w / 110, 2), ink * 0.6, cv::FILLED, cv::LINE_AA);
        last = next;
      }
    }
  }
  return image;
}

cv::Mat page_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, cv::Scalar(236, 240, 242));
  const int w = size.width, h = size.height, line = std::max(h / 45, 5);
  write_words(rng, &image, cv::Rect(w / 10, h / 14, w * 6 / 10, h / 20), {40, 40, 40});
  const int picture = rng.uniform(h / 4, h * 2 / 3);
  write_lines(rng, &image, cv::Rect(w / 10, h / 6, w * 8 / 10, picture - h / 6), line,
              {70, 70, 70});
  if (rng.uniform(0, 2) == 0) {
    const cv::Size inner(w / 2, h / 5);
    landscape_print(rng, inner).copyTo(image(cv::Rect({w / 10, picture}, inner)));
  }
  write_lines(rng, &image, cv::Rect(w / 10, picture + h / 4, w * 8 / 10, h * 7 / 10 - picture),
              line, {70, 70, 70});
  return image;
}

cv::Mat whiteboard_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, cv::Scalar(236, 236, 234));
  add_octaves(rng, &image, 4.0, {4, 3});  // wiped badly
  const int w = size.width, h = size.height;
  const cv::Scalar pens[4] = {{60, 40, 30}, {150, 70, 30}, {40, 40, 170}, {70, 120, 40}};
  std::vector<cv::Point> boxes;
  for (int i = 0; i < 7; ++i) {  // a diagram
    const cv::Point at(rng.uniform(w / 20, w * 6 / 10), rng.uniform(h / 12, h * 8 / 10));
    const cv::Size box(w / 9, h / 9);
    const cv::Scalar& pen = pens[rng.uniform(0, 4)];
    if (!boxes.empty()) cv::arrowedLine(image, boxes.back(), at, pens[0], 3, cv::LINE_AA, 0, 0.1);
    cv::rectangle(image, cv::Rect(at, box), pen, 3, cv::LINE_AA);
    write_words(rng, &image, cv::Rect(at.x + 6, at.y + box.height / 3, box.width - 8, h / 22), pen);
    boxes.push_back(at + cv::Point(box.width, box.height / 2));
  }
  write_lines(rng, &image, cv::Rect(w * 7 / 10, h / 10, w / 4, h / 2), h / 20, pens[1]);
  std::vector<cv::Point> curve;
  for (int i = 0; i < 60; ++i) {
    curve.emplace_back(w * 7 / 10 + i * w / 260,
                       h * 8 / 10 - cvRound(h / 9 * std::sin(i * 0.21) * std::exp(-0.02 * i)));
  }
  cv::polylines(image, curve, false, pens[2], 3, cv::LINE_AA);
  cv::line(image, {w * 7 / 10, h * 8 / 10}, {w * 94 / 100, h * 8 / 10}, pens[0], 3, cv::LINE_AA);
  cv::rectangle(image, cv::Rect(0, 0, w, h), {150, 150, 150}, std::max(w / 60, 3));
  return image;
}

cv::Mat cork_board_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, cv::Scalar(95, 140, 178));
  for (int i = 0; i < size.area() / 60; ++i) {
    cv::circle(image, {rng.uniform(0, size.width), rng.uniform(0, size.height)}, rng.uniform(1, 3),
               cv::Scalar(90, 135, 172) * rng.uniform(0.75, 1.2), cv::FILLED);
  }
  const int h = size.height;
  for (int i = 0; i < 14; ++i) {
    const cv::Size note(h * rng.uniform(14, 28) / 100, h * rng.uniform(14, 30) / 100);
    const cv::Point at(rng.uniform(4, std::max(size.width - note.width - 4, 5)),
                       rng.uniform(4, std::max(h - note.height - 4, 5)));
    const cv::Mat print = rng.uniform(0, 3) == 0 ? any_poster_print(rng, note)
                          : rng.uniform(0, 2)    ? page_print(rng, note)
                                              : cv::Mat(note, CV_8UC3, cv::Scalar(110, 225, 240));
    fill_box(&image, at.x + 3, at.y + 3, note.width, note.height, {55, 85, 110});  // its shade
    print.copyTo(image(cv::Rect(at, note) & cv::Rect(cv::Point(), size)));
    cv::circle(image, at + cv::Point(note.width / 2, 6), 5, room_colour(rng, 30, 200), cv::FILLED,
               cv::LINE_AA);
  }
  cv::rectangle(image, cv::Rect(0, 0, size.width, h), {60, 90, 120}, std::max(h / 30, 3));
  return image;
}

cv::Mat editor_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, cv::Scalar(44, 34, 30));
  const int w = size.width, h = size.height, line = std::max(h / 34, 8);
  fill_box(&image, 0, 0, w / 6, h, {58, 46, 42});
  fill_box(&image, 0, 0, w, line * 3 / 2, {78, 64, 58});
  write_lines(rng, &image, cv::Rect(6, line * 2, w / 7, h / 2), line, {170, 160, 150});
  const cv::Scalar inks[5] = {
      {215, 215, 210}, {120, 200, 130}, {230, 170, 90}, {90, 160, 235}, {190, 120, 210}};
  int indent = 0;
  for (int y = line * 2; y + line < h; y += line * 5 / 4) {
    indent = std::clamp(indent + rng.uniform(-1, 2), 0, 5);
    int x = w / 6 + line + indent * line * 2;
    const int parts = rng.uniform(0, 5);
    for (int i = 0; i < parts && x < w * 9 / 10; ++i) {
      const int width = std::min(rng.uniform(line * 2, line * 8), w - x - 4);
      write_words(rng, &image, cv::Rect(x, y, width, line), inks[rng.uniform(0, 5)]);
      x += width + line / 2;
    }
  }
  fill_box(&image, 0, h - line, w, line, {160, 90, 20});
  return image;
}

cv::Mat browser_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, cv::Scalar(246, 246, 246));
  const int w = size.width, h = size.height, line = std::max(h / 30, 8);
  fill_box(&image, 0, 0, w, line * 2, {200, 195, 190});
  fill_box(&image, w / 12, line / 2, w * 2 / 3, line, {250, 250, 250});
  fill_box(&image, 0, line * 2, w, line * 2, room_colour(rng, 60, 150));
  write_words(rng, &image, cv::Rect(w / 20, line * 5 / 2, w / 2, line), {250, 250, 250});
  for (int i = 0; i < 3; ++i) {
    const int y = line * 5 + i * (h - line * 6) / 3;
    const cv::Size picture(w / 4, (h - line * 6) / 4);
    any_poster_print(rng, picture).copyTo(image(cv::Rect({w / 20, y}, picture)));
    write_words(rng, &image, cv::Rect(w / 3, y, w / 2, line * 3 / 2), {150, 60, 20});
    write_lines(rng, &image, cv::Rect(w / 3, y + line * 2, w * 6 / 10, picture.height - line * 2),
                line, {70, 70, 70});
  }
  return image;
}

cv::Mat keyboard_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, cv::Scalar(46, 46, 48));
  const int key = size.height / 6;
  for (int row = 0; row < 6; ++row) {
    for (int x = key / 4 + row * key / 4 % key; x + key < size.width;) {
      const bool space = row == 5 && x > size.width / 4 && x < size.width / 3;
      const int width = space ? size.width / 4 : key * rng.uniform(90, 115) / 100;
      fill_box(&image, x + 1, row * key + 1, width - 3, key - 3, {84, 82, 82});
      fill_box(&image, x + key / 4, row * key + key / 4, key / 4, key / 4,
               cv::Scalar::all(rng.uniform(170, 230)));
      x += width;
    }
  }
  return image;
}

cv::Mat book_spine_print(cv::RNG& rng, cv::Size size) {
  static const cv::Scalar covers[8] = {{225, 230, 232}, {40, 40, 44}, {45, 40, 150},
                                       {120, 70, 30},   {70, 95, 45}, {60, 140, 205},
                                       {175, 190, 200}, {90, 60, 100}};
  const cv::Scalar cover = covers[rng.uniform(0, 8)];
  cv::Mat image = plain_image(size, cover * rng.uniform(0.75, 1.08));
  const cv::Scalar ink = cv::sum(image(cv::Rect(0, 0, 1, 1)))[0] > 120 ? cv::Scalar(40, 35, 40)
                                                                       : cv::Scalar(215, 225, 230);
  const int w = size.width, h = size.height;
  // The title runs along the spine: written lying, then turned.
  cv::Mat lying(w, h, CV_8UC3, image.at<cv::Vec3b>(0, 0)), title;
  write_words(rng, &lying, cv::Rect(h / 6, w / 5, h * rng.uniform(35, 60) / 100, w * 3 / 5), ink);
  cv::rotate(lying, title, cv::ROTATE_90_CLOCKWISE);
  title.copyTo(image);
  if (rng.uniform(0, 2) == 0) fill_box(&image, 0, h / 14, w, h / 30 + 1, ink);
  if (rng.uniform(0, 2) == 0) fill_box(&image, 0, h * 8 / 10, w, h / 10, room_colour(rng));
  fill_box(&image, w / 4, h * 92 / 100, w / 2, h / 28 + 1, ink);
  return image;
}

cv::Mat binder_spine_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image = plain_image(size, room_colour(rng, 30, 130));
  const int w = size.width, h = size.height;
  add_octaves(rng, &image, 8.0, {4, 12});
  fill_box(&image, w / 6, h / 8, w * 2 / 3, h * 45 / 100, {228, 232, 235});
  write_lines(rng, &image, cv::Rect(w / 5, h / 6, w * 6 / 10, h / 3), std::max(h / 20, 6),
              {50, 40, 40});
  cv::circle(image, {w / 2, h * 8 / 10}, w / 5, {165, 165, 165}, std::max(w / 16, 1), cv::LINE_AA);
  cv::circle(image, {w / 2, h * 8 / 10}, w / 7, {20, 20, 20}, cv::FILLED, cv::LINE_AA);
  return image;
}

cv::Mat cardboard_print(cv::RNG& rng, cv::Size size) {
  const cv::Scalar brown(92, 132, 168);
  cv::Mat image = plain_image(size, brown * rng.uniform(0.85, 1.1));
  add_octaves(rng, &image, 6.0, {4, 4});
  const int w = size.width, h = size.height;
  fill_box(&image, w * 44 / 100, 0, w * 12 / 100, h / 4, brown * 1.3);  // tape
  const cv::Rect label(w * rng.uniform(8, 50) / 100, h * rng.uniform(30, 55) / 100, w * 36 / 100,
                       h * 30 / 100);
  cv::rectangle(image, label, {232, 235, 238}, cv::FILLED);
  write_lines(rng, &image, cv::Rect(label.x + 4, label.y + 4, label.width - 8, label.height / 2),
              std::max(h / 18, 7), {50, 45, 45});
  for (int x = label.x + 4; x < label.br().x - 6; x += rng.uniform(3, 7)) {  // bar code
    fill_box(&image, x, label.y + label.height * 6 / 10, rng.uniform(1, 4), label.height / 3,
             {30, 30, 30});
  }
  write_words(rng, &image, cv::Rect(w / 12, h * 8 / 100 + 2, w * 3 / 10, h / 9), brown * 0.4);
  const cv::Point arrow[3] = {
      {w * 88 / 100, h * 70 / 100}, {w * 94 / 100, h * 86 / 100}, {w * 82 / 100, h * 86 / 100}};
  cv::fillConvexPoly(image, arrow, 3, brown * 0.4, cv::LINE_AA);
  cv::rectangle(image, cv::Rect(0, 0, w, h), brown * 0.75, 2);
  return image;
}

cv::Mat street_print(cv::RNG& rng, cv::Size size) {
  cv::Mat image(size, CV_8UC3);
  const int w = size.width, h = size.height;
  for (int y = 0; y < h; ++y)
    image.row(y).setTo(cv::Scalar(235, 215 + y * 20 / h, 190 + y * 40 / h));
  add_octaves(rng, &image, 8.0, {3, 5});
  for (int x = -w / 20; x < w;) {  // houses across the street
    const int width = rng.uniform(w / 6, w / 3), top = rng.uniform(h / 5, h * 6 / 10);
    const cv::Scalar wall = room_colour(rng, 110, 210);
    fill_box(&image, x, top, width, h - top, wall);
    const int step = std::max(width / rng.uniform(4, 7), 8);
    for (int wy = top + step / 2; wy + step < h * 9 / 10; wy += step * 4 / 3) {
      for (int wx = x + step / 3; wx + step / 2 < x + width; wx += step) {
        fill_box(&image, wx, wy, step / 2, step * 3 / 4, wall * rng.uniform(0.3, 0.6));
      }
    }
    x += width;
  }
  for (int i = 0; i < 60; ++i) {
    cv::circle(image, {rng.uniform(0, w), h - rng.uniform(0, h / 5)}, h / rng.uniform(16, 40),
               cv::Scalar(60, 110, 75) * rng.uniform(0.6, 1.5), cv::FILLED, cv::LINE_AA);
  }
  return image;
}

cv::Mat door_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour) {
  cv::Mat image = grain_print(rng, size, colour);
  const int w = size.width, h = size.height;
  for (int i = 0; i < 2; ++i) {
    const cv::Rect panel(w / 6, h / 12 + i * h / 2, w * 2 / 3, h * (i == 0 ? 38 : 32) / 100);
    cv::rectangle(image, panel, colour * 0.7, 4, cv::LINE_AA);
    cv::rectangle(image, panel + cv::Point(3, 3), colour * 1.2, 2, cv::LINE_AA);
  }
  fill_box(&image, w * 86 / 100, h * 48 / 100, w / 14, h / 14, {170, 175, 178});
  fill_box(&image, w * 78 / 100, h * 50 / 100, w / 9, h / 90 + 2, {120, 125, 128});
  return image;
}

cv::Mat cabinet_front_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, int columns,
                            int rows) {
  cv::Mat image = grain_print(rng, size, colour);
  const int w = size.width / columns, h = size.height / rows;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      cv::rectangle(image, cv::Rect(x * w + 1, y * h + 1, w - 2, h - 2), colour * 0.45, 2);
      const int knob = x % 2 == 0 ? x * w + w * 88 / 100 : x * w + w * 12 / 100;
      fill_box(&image, knob - 3, y * h + h * 4 / 10, 7, h / 5, {195, 200, 202});
      fill_box(&image, knob + 4, y * h + h * 4 / 10 + 2, 2, h / 5, colour * 0.4);
    }
  }
  return image;
}

cv::Mat any_poster_print(cv::RNG& rng, cv::Size size) {
  const int kind = rng.uniform(0, 4);
  cv::Mat image = kind == 0   ? landscape_print(rng, size)
                  : kind == 1 ? chart_print(rng, size)
                  : kind == 2 ? abstract_print(rng, size)
                              : poster_pattern(rng, size);
  return image;
}

}  // namespace dkp_slam
