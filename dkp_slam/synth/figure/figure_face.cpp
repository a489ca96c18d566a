#include "dkp_slam/synth/figure/figure_face.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/synth/mesh/patterns.h"

namespace dkp_slam {
namespace {

/// A face as `figure_head` unrolls it: angles from the front and heights above the chin, in
/// radians and metres, become pixels.
class FacePainter {
 public:
  FacePainter(const cv::Size& size, const cv::Scalar& skin) : image_(size, CV_8UC3, skin) {}

  cv::Point2d at(double angle, double height) const {
    // The inverse of figure_loft.h's loft_angle, by a few steps of Newton's method.
    double even = angle;
    for (int i = 0; i < 8; ++i) {
      even -= (even - frontal * std::sin(even) - angle) / (1.0 - frontal * std::cos(even));
    }
    return {(0.5 + even / (2.0 * CV_PI)) * image_.cols, (top - height) / span * image_.rows};
  }

  /// A spot of a colour, soft by `blur` pixels, covering by `share`.
  void spot(double angle, double height, double half_angle, double half_height,
            const cv::Scalar& colour, double share, double blur) {
    const cv::Point2d centre = at(angle, height);
    const cv::Size2d half(std::abs(at(angle + half_angle, height).x - centre.x),
                          half_height / span * image_.rows);
    const cv::Rect box = around(cv::Rect2d(centre.x - half.width, centre.y - half.width,
                                           2.0 * half.width, 2.0 * half.width) |
                                    cv::Rect2d(centre.x - half.height, centre.y - half.height,
                                               2.0 * half.height, 2.0 * half.height),
                                blur);
    const cv::Point2d middle = centre - cv::Point2d(box.tl());
    cv::Mat mask = cv::Mat::zeros(box.size(), CV_32F);
    constexpr int shift = 4;
    cv::ellipse(mask, cv::Point(cvRound(middle.x * 16), cvRound(middle.y * 16)),
                cv::Size(cvRound(half.width * 16), cvRound(half.height * 16)), 0, 0, 360,
                cv::Scalar(share), cv::FILLED, cv::LINE_8, shift);
    blend(box, mask, blur, colour);
  }

  void line(const std::vector<cv::Point2d>& points, double width, const cv::Scalar& colour,
            double share, double blur) {
    cv::Rect2d bounds(points.front(), points.back());
    for (const cv::Point2d& p : points) bounds |= cv::Rect2d(p, cv::Size2d(1.0, 1.0));
    const cv::Rect box = around(bounds, blur + width);
    const cv::Point2d origin = box.tl();
    cv::Mat mask = cv::Mat::zeros(box.size(), CV_32F);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      cv::line(mask, points[i] - origin, points[i + 1] - origin, cv::Scalar(share),
               std::max(cvRound(width), 1));
    }
    blend(box, mask, blur, colour);
  }

  cv::Mat& image() { return image_; }

 private:
  static cv::Rect around(const cv::Rect2d& bounds, double blur) {
    const int margin = cvRound(3.0 * blur) + 3;
    return {cvFloor(bounds.x) - margin, cvFloor(bounds.y) - margin,
            cvCeil(bounds.width) + 2 * margin, cvCeil(bounds.height) + 2 * margin};
  }

  void blend(const cv::Rect& box, cv::Mat& mask, double blur, const cv::Scalar& colour) {
    if (blur > 0.0) cv::GaussianBlur(mask, mask, cv::Size(), blur, blur);
    const cv::Rect seen = box & cv::Rect(cv::Point(), image_.size());
    for (int y = seen.y; y < seen.br().y; ++y) {
      const auto* share = mask.ptr<float>(y - box.y);
      auto* pixel = image_.ptr<cv::Vec3b>(y);
      for (int x = seen.x; x < seen.br().x; ++x) {
        for (int c = 0; c < 3; ++c) {
          const double mixed = pixel[x][c] + share[x - box.x] * (colour[c] - pixel[x][c]);
          pixel[x][c] = cv::saturate_cast<unsigned char>(mixed);
        }
      }
    }
  }

  static constexpr double frontal = 0.45;      // as in figure_head.cpp
  static constexpr double top = 0.228;         // metres above the chin
  static constexpr double span = top + 0.080;  // down to the neck's end
  cv::Mat image_;
};

void paint_eyes(FacePainter& face, const FigureLook& look) {
  const cv::Scalar skin = look.skin, brow = look.hair * 0.6 + skin * 0.1;
  for (const double side : {-1.0, 1.0}) {
    const double a = side * 0.36;
    face.spot(a, 0.118, 0.24, 0.016, skin * 0.62, 0.55, 6.0);
    face.spot(a, 0.116, 0.135, 0.0062, {222, 226, 228}, 1.0, 0.8);
    face.spot(a, 0.1165, 0.060, 0.0062, {45, 62, 82}, 1.0, 0.6);
    face.spot(a, 0.1165, 0.028, 0.0032, {12, 12, 12}, 1.0, 0.5);
    face.spot(a + 0.02, 0.1185, 0.012, 0.0014, {250, 250, 250}, 0.9, 0.3);
    const std::vector<cv::Point2d> lid = {face.at(a - 0.155, 0.115), face.at(a - 0.07, 0.1215),
                                          face.at(a + 0.04, 0.1222), face.at(a + 0.155, 0.115)};
    face.line(lid, look.woman ? 5.0 : 3.5, skin * 0.22, 1.0, 0.8);
    const std::vector<cv::Point2d> lower = {face.at(a - 0.14, 0.114), face.at(a, 0.1095),
                                            face.at(a + 0.14, 0.114)};
    face.line(lower, 2.0, skin * 0.5, 0.7, 1.0);
    const std::vector<cv::Point2d> arch = {
        face.at(side * 0.17, 0.133), face.at(side * 0.34, 0.1395), face.at(side * 0.56, 0.133)};
    face.line(arch, look.woman ? 6.0 : 10.0, brow, 0.9, 1.6);
  }
}

void paint_nose_and_mouth(FacePainter& face, const FigureLook& look) {
  const cv::Scalar skin = look.skin;
  const cv::Scalar red(skin[0] * 0.72, skin[1] * 0.72, std::min(skin[2] * 1.02, 255.0));
  for (const double side : {-1.0, 1.0}) {
    face.spot(side * 0.17, 0.100, 0.05, 0.022, skin * 0.72, 0.45, 5.0);
    face.spot(side * 0.10, 0.0705, 0.045, 0.0035, skin * 0.30, 0.9, 1.2);
    face.line({face.at(side * 0.22, 0.078), face.at(side * 0.34, 0.055)}, 4.0, skin * 0.70, 0.5,
              2.5);
    face.spot(side * 0.62, 0.085, 0.25, 0.018, red, 0.30, 12.0);
  }
  face.spot(0.0, 0.100, 0.05, 0.026, skin * 1.12, 0.5, 5.0);
  face.spot(0.0, 0.068, 0.16, 0.004, skin * 0.62, 0.6, 2.5);
  const cv::Scalar lips =
      look.woman ? cv::Scalar(red[0] * 0.80, red[1] * 0.72, red[2] * 0.95) : red * 0.88;
  face.spot(0.0, 0.0525, 0.245, 0.0045, lips, 0.95, 1.2);
  face.spot(0.0, 0.0440, 0.200, 0.0052, lips * 1.06, 0.95, 1.2);
  face.line({face.at(-0.27, 0.0485), face.at(-0.08, 0.0495), face.at(0.0, 0.0482),
             face.at(0.08, 0.0495), face.at(0.27, 0.0485)},
            2.5, skin * 0.25, 1.0, 0.7);
  face.spot(0.0, 0.034, 0.16, 0.004, skin * 0.70, 0.5, 3.0);
}

}  // namespace

cv::Mat paint_head(cv::RNG& rng, const FigureLook& look) {
  FacePainter face({1024, 512}, look.skin);
  const cv::Scalar skin = look.skin;
  // Under the jaw and chin, and the neck's sides.
  face.spot(0.0, -0.025, 1.6, 0.020, skin * 0.62, 0.75, 9.0);
  if (!look.woman) {
    const double share = look.beard ? 0.85 : 0.16;
    const cv::Scalar stubble = look.hair * 0.75;
    face.spot(0.0, 0.016, 0.75, 0.020, stubble, share, 5.0);
    for (const double side : {-1.0, 1.0}) {
      face.spot(side * 0.70, 0.022, 0.40, 0.022, stubble, share, 6.0);
      face.spot(side * 1.10, 0.050, 0.28, 0.038, stubble, share, 6.0);
    }
    face.spot(0.0, 0.0605, 0.26, 0.0045, stubble, share, 2.0);
  }
  paint_eyes(face, look);
  paint_nose_and_mouth(face, look);
  add_wrapped_octaves(rng, &face.image(), 4.0, {16, 8});
  return face.image();
}

cv::Mat paint_hair(cv::RNG& rng, const FigureLook& look) {
  cv::Mat image(cv::Size(512, 256), CV_8UC3, look.hair);
  // Strands: noise that varies around the head and hardly along it, twice as a fine and a coarse
  // one.
  cv::Mat strands = cv::Mat::zeros(image.size(), CV_32F);
  for (const int across : {64, 256}) {
    cv::Mat coarse(cv::Size(across, 5), CV_32F), fine;
    rng.fill(coarse, cv::RNG::UNIFORM, -0.30, 0.34);
    cv::resize(coarse, fine, image.size(), 0, 0, cv::INTER_CUBIC);
    strands += fine;
  }
  for (int y = 0; y < image.rows; ++y) {
    const double v = static_cast<double>(y) / image.rows;
    // The gloss where lamps reflect, and the shade of the ends.
    const double gloss = 0.35 * std::exp(-0.5 * std::pow((v - 0.35) / 0.12, 2.0)) - 0.25 * v * v;
    for (int x = 0; x < image.cols; ++x) {
      const double factor = 1.0 + strands.at<float>(y, x) + gloss;
      auto& pixel = image.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) {
        pixel[c] = cv::saturate_cast<unsigned char>(pixel[c] * factor + 4.0);
      }
    }
  }
  return image;
}

cv::Mat paint_skin(cv::RNG& rng, const FigureLook& look) {
  cv::Mat image(cv::Size(128, 128), CV_8UC3, look.skin * 0.97);
  // Nails and knuckles are too small to see; the tips are a little redder.
  for (int y = 90; y < image.rows; ++y) {
    image.row(y) = cv::Scalar(look.skin[0] * 0.88, look.skin[1] * 0.9, look.skin[2] * 0.98);
  }
  add_octaves(rng, &image, 5.0);
  return image;
}

}  // namespace dkp_slam
