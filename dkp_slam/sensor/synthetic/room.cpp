#include "dkp_slam/sensor/synthetic/room.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/sensor/synthetic/patterns.h"

namespace dkp_slam {
namespace {

// At two metres a pixel of a 640 x 480 camera sees 3.7 mm.
constexpr double texels_per_metre = 400.0;

using Pattern = std::function<cv::Mat(cv::Size)>;

cv::Size texels(double width, double height) {
  return {std::max(static_cast<int>(width * texels_per_metre), 4),
          std::max(static_cast<int>(height * texels_per_metre), 4)};
}

class RoomBuilder {
 public:
  RoomBuilder(cv::RNG& rng, const RoomSize& size) : rng_(rng), size_(size) {}

  std::vector<Panel> build() {
    add_shell();
    add_desk();
    add_shelf_and_cabinet();
    add_small_furniture();
    return std::move(panels_);
  }

 private:
  void add_panel(const Eigen::Vector3d& origin, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                 const cv::Mat& image) {
    panels_.push_back({origin, u, v, std::make_shared<Texture>(image)});
  }

  /// Upright or lying box without its bottom; `yaw` turns it about the vertical through its middle.
  /// `front` covers the side towards negative y (before turning), `rest` all others.
  void add_box(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, double yaw,
               const Pattern& rest, const Pattern& front = nullptr) {
    const Eigen::AngleAxisd turn(yaw, Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d x = turn * Eigen::Vector3d(size.x(), 0, 0);
    const Eigen::Vector3d y = turn * Eigen::Vector3d(0, size.y(), 0);
    const Eigen::Vector3d z(0, 0, size.z());
    const Eigen::Vector3d top = centre + 0.5 * z;  // textures begin at the top left corner
    const auto side = [&](const Pattern& pattern, const Eigen::Vector3d& corner,
                          const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
      add_panel(corner, u, v, pattern(texels(u.norm(), v.norm())));
    };
    side(front ? front : rest, top - 0.5 * x - 0.5 * y, x, -z);
    side(rest, top + 0.5 * x + 0.5 * y, -x, -z);
    side(rest, top - 0.5 * x + 0.5 * y, -y, -z);
    side(rest, top + 0.5 * x - 0.5 * y, y, -z);
    side(rest, top - 0.5 * x + 0.5 * y, x, -y);
    // A table's top is seen from below too.
    side(rest, top - z - 0.5 * x + 0.5 * y, x, -y);
  }

  /// A wall's paint with posters hung in a loose row, painted into it.
  cv::Mat wall(double width, const cv::Scalar& colour) {
    cv::Mat image = paint_pattern(rng_, texels(width, size_.height), colour, 7.0);
    const auto px = [](double metres) { return static_cast<int>(metres * texels_per_metre); };
    // Wallpaper: small faint leaves, so that no part of the view is without corners.
    constexpr double leaves_per_square_metre = 55.0;
    for (int i = 0; i < leaves_per_square_metre * width * size_.height; ++i) {
      const int x = rng_.uniform(0, image.cols), y = rng_.uniform(0, image.rows);
      const int longer = rng_.uniform(4, 11);
      cv::ellipse(image, {x, y}, {longer, longer / 3 + 1}, rng_.uniform(0.0, 180.0), 0, 360,
                  colour * rng_.uniform(0.50, 0.78), cv::FILLED, cv::LINE_AA);
    }
    for (double x = 0.15; x < width - 0.75;) {
      const double w = rng_.uniform(0.35, 0.75), h = rng_.uniform(0.40, 0.85);
      const double y = rng_.uniform(0.45, 0.75);
      if (x + w > width - 0.1) break;
      poster_pattern(rng_, {px(w), px(h)}).copyTo(image(cv::Rect(px(x), px(y), px(w), px(h))));
      if (rng_.uniform(0, 2) == 0) {
        const cv::Mat note = poster_pattern(rng_, {px(0.21), px(0.30)});
        note.copyTo(image(cv::Rect(px(x + 0.05), px(y + h + 0.08), note.cols, note.rows)));
      }
      x += w + rng_.uniform(0.12, 0.40);
    }
    // Skirting board and socket.
    cv::rectangle(image, cv::Rect(0, image.rows - px(0.08), image.cols, px(0.08)),
                  cv::Scalar(120, 140, 150), cv::FILLED);
    const int socket = rng_.uniform(px(0.3), image.cols - px(0.3));
    cv::rectangle(image, cv::Rect(socket, image.rows - px(0.35), px(0.16), px(0.09)),
                  cv::Scalar(225, 225, 225), cv::FILLED);
    return image;
  }

  void add_shell() {
    const RoomSize& s = size_;
    const double w = s.right - s.left, d = s.front - s.back;
    const Eigen::Vector3d x(w, 0, 0), y(0, d, 0), down(0, 0, -s.height);
    const cv::Scalar paint(168, 182, 188);
    add_panel({s.left, s.front, s.height}, x, down, wall(w, paint));
    add_panel({s.right, s.back, s.height}, -x, down, wall(w, paint * 0.95));
    add_panel({s.left, s.back, s.height}, y, down, wall(d, cv::Scalar(170, 178, 165)));
    add_panel({s.right, s.front, s.height}, -y, down, wall(d, cv::Scalar(165, 170, 182)));
    add_panel({s.left, s.back, 0}, x, y, carpet_pattern(rng_, texels(w, d), {98, 92, 104}));
    cv::Mat ceiling = paint_pattern(rng_, texels(w, d), cv::Scalar(205, 208, 210), 5.0);
    constexpr int tile = 240;  // texels: tiles of 60 cm
    for (int i = 0; i < std::max(ceiling.cols, ceiling.rows); i += tile) {
      cv::line(ceiling, {i, 0}, {i, ceiling.rows}, cv::Scalar(150, 150, 150), 3);
      cv::line(ceiling, {0, i}, {ceiling.cols, i}, cv::Scalar(150, 150, 150), 3);
    }
    add_panel({s.left, s.back, s.height}, x, y, ceiling);
  }

  Pattern wood(const cv::Scalar& colour) {
    return [this, colour](cv::Size size) { return wood_pattern(rng_, size, colour); };
  }
  Pattern plain(const cv::Scalar& colour) {
    return [this, colour](cv::Size size) { return paint_pattern(rng_, size, colour, 8.0); };
  }
  Pattern poster() {
    return [this](cv::Size size) { return poster_pattern(rng_, size); };
  }
  Pattern checks(int cell) {
    return [this, cell](cv::Size size) { return checks_pattern(rng_, size, cell); };
  }

  void add_desk() {
    const cv::Scalar oak(105, 150, 185), metal(110, 110, 115);
    add_box({0.0, 1.35, 0.72}, {2.0, 0.80, 0.04}, 0.0, wood(oak));
    for (const double x : {-0.94, 0.94}) {
      for (const double y : {1.01, 1.69}) {
        add_box({x, y, 0.35}, {0.06, 0.06, 0.70}, 0.0, plain(metal));
      }
    }
    const Pattern screen = [this](cv::Size size) { return screen_pattern(rng_, size); };
    for (const auto& [x, yaw] : {std::pair{-0.36, 0.14}, std::pair{0.36, -0.16}}) {
      add_box({x, 1.50, 1.05}, {0.56, 0.05, 0.36}, yaw, plain({55, 55, 60}), screen);
      add_box({x, 1.53, 0.81}, {0.08, 0.06, 0.14}, yaw, plain({70, 70, 75}));
      add_box({x, 1.52, 0.75}, {0.26, 0.20, 0.02}, yaw, plain({60, 60, 65}));
    }
    add_box({-0.25, 1.16, 0.75}, {0.44, 0.15, 0.02}, 0.05, checks(8));
    add_box({0.78, 1.22, 0.80}, {0.22, 0.29, 0.12}, 0.5, poster());
    add_box({0.76, 1.23, 0.89}, {0.20, 0.26, 0.06}, 0.2, poster());
    add_box({-0.80, 1.25, 0.82}, {0.16, 0.16, 0.16}, 0.7, checks(16));
    add_box({0.20, 1.14, 0.79}, {0.08, 0.08, 0.10}, 0.3, plain({70, 90, 180}));
  }

  void add_shelf_and_cabinet() {
    const Pattern books = [this](cv::Size size) { return books_pattern(rng_, size, 130); };
    const double y = size_.front - 0.18;
    add_box({1.75, y, 0.95}, {1.10, 0.32, 1.90}, 0.0, wood({95, 135, 165}), books);
    const Pattern doors = [this](cv::Size size) {
      cv::Mat image = wood_pattern(rng_, size, cv::Scalar(120, 150, 170));
      cv::rectangle(image, cv::Rect(6, 6, size.width / 2 - 9, size.height - 12),
                    cv::Scalar(70, 90, 105), 3);
      cv::rectangle(image, cv::Rect(size.width / 2 + 3, 6, size.width / 2 - 9, size.height - 12),
                    cv::Scalar(70, 90, 105), 3);
      return image;
    };
    add_box({-1.85, y - 0.07, 0.50}, {1.0, 0.46, 1.00}, 0.0, wood({110, 140, 160}), doors);
    add_box({-2.05, y - 0.05, 1.13}, {0.36, 0.30, 0.26}, 0.3, poster());
    add_box({-1.60, y - 0.08, 1.10}, {0.30, 0.28, 0.20}, -0.2, checks(20));
    add_box({0.15, y - 0.10, 0.30}, {0.60, 0.40, 0.60}, 0.0, poster());
  }

  void add_small_furniture() {
    const cv::Scalar blue(130, 95, 70), metal(90, 90, 95);
    // A chair under the desk, where the walkers do not pass.
    add_box({0.10, 0.86, 0.45}, {0.44, 0.42, 0.06}, 0.2, poster());
    add_box({0.06, 0.67, 0.72}, {0.42, 0.05, 0.46}, 0.2, plain(blue), poster());
    add_box({0.10, 0.86, 0.21}, {0.07, 0.07, 0.42}, 0.2, plain(metal));
    add_box({2.42, 1.2, 0.40}, {0.45, 1.0, 0.80}, 0.0, wood({90, 120, 150}));
    add_box({2.40, 1.1, 0.95}, {0.34, 0.40, 0.30}, 0.3, poster());
    add_box({-2.45, 0.9, 0.30}, {0.40, 0.60, 0.60}, 0.1, poster());
    add_box({-2.42, 0.85, 0.75}, {0.30, 0.36, 0.30}, -0.3, checks(24));
    add_box({-1.9, -1.9, 0.45}, {0.9, 0.6, 0.90}, 0.2, wood({100, 130, 160}), poster());
    add_box({1.9, -1.9, 0.60}, {0.7, 0.6, 1.20}, -0.3, poster());
  }

  cv::RNG& rng_;
  RoomSize size_;
  std::vector<Panel> panels_;
};

}  // namespace

std::vector<Panel> build_room(cv::RNG& rng, const RoomSize& size) {
  return RoomBuilder(rng, size).build();
}

}  // namespace dkp_slam
