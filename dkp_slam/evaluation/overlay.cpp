#include "dkp_slam/evaluation/overlay.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/detection/class_table.h"

namespace dkp_slam {
namespace {

const cv::Scalar low_colour(90, 220, 60);
const cv::Scalar suspicious_colour(255, 150, 30);
const cv::Scalar high_colour(60, 60, 255);
const cv::Scalar mask_colour(50, 50, 230);
const cv::Scalar dark(25, 25, 25);
const cv::Scalar white(245, 245, 245);

cv::Scalar colour_of(Region region) {
  switch (region) {
    case Region::high:
      return high_colour;
    case Region::suspicious:
      return suspicious_colour;
    case Region::low:
      break;
  }
  return low_colour;
}

void tint_mask(const cv::Mat& mask, cv::Mat& canvas) {
  constexpr double opacity = 0.35;
  cv::Mat tinted;
  cv::addWeighted(canvas, 1.0 - opacity, cv::Mat(canvas.size(), canvas.type(), mask_colour),
                  opacity, 0.0, tinted);
  tinted.copyTo(canvas, mask);
  std::vector<std::vector<cv::Point>> outline;
  cv::findContours(mask.clone(), outline, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  cv::drawContours(canvas, outline, -1, mask_colour, 1, cv::LINE_AA);
}

void dashed_line(cv::Mat& canvas, cv::Point a, cv::Point b, const cv::Scalar& colour) {
  constexpr double dash = 8.0;  // pixels, and as much gap
  const double length = cv::norm(b - a);
  for (double s = 0.0; s < length; s += 2.0 * dash) {
    const double e = std::min(length, s + dash);
    const cv::Point2d unit = cv::Point2d(b - a) / length;
    cv::line(canvas, cv::Point(cv::Point2d(a) + unit * s), cv::Point(cv::Point2d(a) + unit * e),
             colour, 2, cv::LINE_AA);
  }
}

/// Text on a dark plate whose bottom left corner is at `at`, moved to stay in the picture.
void draw_label(cv::Mat& canvas, cv::Point at, const std::string& text, const cv::Scalar& colour) {
  constexpr double size = 0.42;
  int below = 0;
  const cv::Size box = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &below);
  at.x = std::clamp(at.x, 0, std::max(0, canvas.cols - box.width - 6));
  at.y = std::clamp(at.y, box.height + 8, canvas.rows - 2);
  const cv::Rect plate(at.x, at.y - box.height - 7, box.width + 6, box.height + 8);
  cv::rectangle(canvas, plate & cv::Rect(0, 0, canvas.cols, canvas.rows), dark, cv::FILLED);
  cv::putText(canvas, text, at + cv::Point(3, -4), cv::FONT_HERSHEY_SIMPLEX, size, colour, 1,
              cv::LINE_AA);
}

void draw_object(const DynamicObject& object, cv::Mat& canvas) {
  const cv::Scalar colour = object.compensated ? cv::Scalar(60, 210, 255) : white;
  const cv::Rect box(object.box);
  const std::array<cv::Point, 5> corners{box.tl(),
                                         {box.br().x - 1, box.y},
                                         box.br() - cv::Point(1, 1),
                                         {box.x, box.br().y - 1},
                                         box.tl()};
  if (object.compensated) {
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      dashed_line(canvas, corners[i], corners[i + 1], colour);
    }
  } else {
    cv::rectangle(canvas, box, colour, 2, cv::LINE_AA);
  }
  const std::string_view name = ClassTable::name(object.class_id);
  const std::string tail = object.compensated ? "carried" : fmt::format("{:.2f}", object.score);
  draw_label(canvas, box.tl(), fmt::format("{} {} {}", object.id, name, tail), colour);
}

void draw_feature(const cv::Point2f& at, const FeatureDynamics& feature, cv::Mat& canvas) {
  constexpr int shift = 3;  // fractional bits
  const auto fixed = [&](float x, float y) {
    return cv::Point(cvRound(x * (1 << shift)), cvRound(y * (1 << shift)));
  };
  const cv::Scalar colour = colour_of(feature.region);
  if (feature.is_static) {
    constexpr float radius = 2.4F;
    cv::circle(canvas, fixed(at.x, at.y), cvRound((radius + 1.0F) * (1 << shift)), dark, cv::FILLED,
               cv::LINE_AA, shift);
    cv::circle(canvas, fixed(at.x, at.y), cvRound(radius * (1 << shift)), colour, cv::FILLED,
               cv::LINE_AA, shift);
    return;
  }
  constexpr float arm = 3.2F;
  for (const int width : {3, 1}) {  // a dark cross under the coloured one
    const cv::Scalar& ink = width == 3 ? dark : colour;
    cv::line(canvas, fixed(at.x - arm, at.y - arm), fixed(at.x + arm, at.y + arm), ink, width,
             cv::LINE_AA, shift);
    cv::line(canvas, fixed(at.x - arm, at.y + arm), fixed(at.x + arm, at.y - arm), ink, width,
             cv::LINE_AA, shift);
  }
}

void draw_legend(const std::vector<FeatureDynamics>& features, cv::Mat& canvas) {
  std::array<int, 3> kept{}, all{};
  for (const FeatureDynamics& f : features) {
    const auto r = static_cast<std::size_t>(f.region);
    ++all[r];
    kept[r] += f.is_static ? 1 : 0;
  }
  int y = canvas.rows - 4;
  for (const auto& [region, name] : {std::pair{Region::high, "high"},
                                     {Region::suspicious, "suspicious"},
                                     {Region::low, "low"}}) {
    const auto r = static_cast<std::size_t>(region);
    draw_label(canvas, {4, y}, fmt::format("{}: {} of {} kept", name, kept[r], all[r]),
               colour_of(region));
    y -= 19;
  }
}

}  // namespace

cv::Mat draw_overlay(const RgbdFrame& frame, const std::vector<cv::KeyPoint>& keypoints,
                     const FrameDynamics& dynamics) {
  cv::Mat canvas = frame.colour.clone();
  if (!dynamics.mask.empty()) tint_mask(dynamics.mask, canvas);
  std::vector<FeatureDynamics> features = dynamics.features;
  features.resize(keypoints.size());
  // Removed ones first: the static ones are what the reader wants to count.
  for (const bool is_static : {false, true}) {
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
      if (features[i].is_static == is_static) draw_feature(keypoints[i].pt, features[i], canvas);
    }
  }
  for (const DynamicObject& object : dynamics.objects) draw_object(object, canvas);
  draw_legend(features, canvas);
  return canvas;
}

}  // namespace dkp_slam
