#include "dkp_slam/sensor/synthetic/kinect_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

constexpr float disparity_steps = 8.0F;   // per pixel
constexpr double edge_shift = 0.5;        // pixels, standard deviation
constexpr float edge_ratio = 1.04F;       // depths of neighbours that differ by more are an edge
constexpr float edge_hole_share = 0.35F;  // of the pixels at an edge
constexpr float shadow_slack = 1.0F;      // pixels
constexpr int noise_cell = 3;             // pixels that share their noise: the matching window

/// Pixels of a row that the projector cannot light become 0. A point at pixel x is lit by the
/// projector's column x - disparity; from right to left these must fall.
void cast_shadows(float focal_baseline, float* row, int width) {
  float leftmost = std::numeric_limits<float>::infinity();
  for (int x = width - 1; x >= 0; --x) {
    if (row[x] <= 0.0F) continue;
    const float column = static_cast<float>(x) - focal_baseline / row[x];
    if (column > leftmost + shadow_slack) {
      row[x] = 0.0F;
    } else {
      leftmost = std::min(leftmost, column);
    }
  }
}

bool at_edge(const cv::Mat& depth, int x, int y) {
  const float here = depth.at<float>(y, x);
  for (const cv::Point& step :
       {cv::Point(-1, 0), cv::Point(1, 0), cv::Point(0, -1), cv::Point(0, 1)}) {
    const int nx = std::clamp(x + step.x, 0, depth.cols - 1);
    const int ny = std::clamp(y + step.y, 0, depth.rows - 1);
    const float there = depth.at<float>(ny, nx);
    if (there > here * edge_ratio || here > there * edge_ratio) return true;
  }
  return false;
}

}  // namespace

cv::Mat kinect_depth(const cv::Mat& depth, const Camera& camera, cv::RNG& rng) {
  CV_Assert(depth.type() == CV_32FC1);
  const auto focal_baseline = static_cast<float>(camera.fx * camera.baseline);
  // The camera's depth noise grows with z^2 as disparity noise of this size does.
  const double sigma = std::max(camera.depth_noise.quadratic * focal_baseline, 0.02);
  cv::Mat coarse(depth.rows / noise_cell + 2, depth.cols / noise_cell + 2, CV_32FC1), noise;
  rng.fill(coarse, cv::RNG::NORMAL, 0.0, sigma);
  cv::resize(coarse, noise, depth.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat shift(depth.size(), CV_32FC2), chance(depth.size(), CV_32FC1);
  rng.fill(shift, cv::RNG::NORMAL, 0.0, edge_shift);
  rng.fill(chance, cv::RNG::UNIFORM, 0.0, 1.0);

  cv::Mat out(depth.size(), CV_32FC1);
  for (int y = 0; y < depth.rows; ++y) {
    auto* row = out.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) {
      const bool edge = at_edge(depth, x, y);
      float true_depth = depth.at<float>(y, x);
      if (edge) {
        const auto& s = shift.at<cv::Vec2f>(y, x);
        true_depth = depth.at<float>(std::clamp(y + cvRound(s[1]), 0, depth.rows - 1),
                                     std::clamp(x + cvRound(s[0]), 0, depth.cols - 1));
      }
      const bool hole = edge && chance.at<float>(y, x) < edge_hole_share;
      row[x] = hole ? 0.0F : true_depth;
    }
    cast_shadows(focal_baseline, row, depth.cols);
    for (int x = 0; x < depth.cols; ++x) {
      if (row[x] <= 0.0F) continue;
      const float disparity = focal_baseline / row[x] + noise.at<float>(y, x);
      const float step = std::round(disparity * disparity_steps) / disparity_steps;
      const float measured = step > 0.0F ? focal_baseline / step : 0.0F;
      const bool known = measured >= static_cast<float>(camera.min_depth) &&
                         measured <= static_cast<float>(camera.max_depth);
      row[x] = known ? measured : 0.0F;
    }
  }
  return out;
}

void add_image_noise(cv::Mat* colour, double sigma, cv::RNG& rng) {
  cv::Mat noise(colour->size(), CV_16SC3);
  // In 16ths of a grey level, since the matrix holds whole numbers.
  constexpr double fraction = 16.0;
  rng.fill(noise, cv::RNG::NORMAL, 0.0, sigma * fraction);
  for (int y = 0; y < colour->rows; ++y) {
    auto* pixel = colour->ptr<std::uint8_t>(y);
    const auto* n = noise.ptr<std::int16_t>(y);
    for (int i = 0; i < colour->cols * 3; ++i) {
      pixel[i] = cv::saturate_cast<std::uint8_t>(pixel[i] + n[i] / fraction);
    }
  }
}

}  // namespace dkp_slam
