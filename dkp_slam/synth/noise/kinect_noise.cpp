#include "dkp_slam/synth/noise/kinect_noise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/geometry/sensor_scale.h"
#include "dkp_slam/synth/noise/counter_random.h"

namespace dkp_slam {
namespace {

// Pixels are those of an image 640 wide, as the sensor's own is: one of another size shows the same
// readings on more or fewer of them.
constexpr float disparity_steps = 8.0F;   // per pixel
constexpr double edge_shift = 0.5;        // pixels, standard deviation
constexpr float edge_ratio = 1.04F;       // depths of neighbours that differ by more are an edge
constexpr float edge_hole_share = 0.35F;  // of the pixels at an edge
constexpr float shadow_slack = 1.0F;      // pixels
constexpr int noise_cell = 3;             // pixels that share their noise: the matching window
// The projected dots fade with distance: beyond `all_seen` more and more patches go unmatched,
// half of them at about 6 m.
constexpr float nearest = 0.4F, all_seen = 4.5F, none_seen = 7.5F;  // metres
constexpr int fading_cell = 5;                                      // pixels: size of the patches

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
  const double scale = SensorScale::of(camera).pixels;
  const auto focal_baseline = static_cast<float>(camera.fx * camera.baseline);
  const auto steps = static_cast<float>(disparity_steps / scale);
  // The camera's depth noise grows with z^2 as disparity noise of this size does.
  const double sigma = std::max(camera.depth_noise.quadratic * focal_baseline, 0.02);
  const auto spread = [&](int usual_cell, int kind, double a, double b) {
    const int cell = std::max(1, cvRound(usual_cell * scale));
    cv::Mat coarse(depth.rows / cell + 2, depth.cols / cell + 2, CV_32FC1), fine;
    rng.fill(coarse, kind, a, b);
    cv::resize(coarse, fine, depth.size(), 0, 0, cv::INTER_LINEAR);
    return fine;
  };
  const cv::Mat noise = spread(noise_cell, cv::RNG::NORMAL, 0.0, sigma);
  const cv::Mat sight = spread(fading_cell, cv::RNG::UNIFORM, 0.0, 1.0);
  const CounterRandom random((static_cast<std::uint64_t>(rng.next()) << 32U) + rng.next());
  const float from = std::max(nearest, static_cast<float>(camera.min_depth));
  const auto to = static_cast<float>(camera.max_depth);

  cv::Mat out(depth.size(), CV_32FC1);
  const auto sense_row = [&](int y) {
    auto* row = out.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) {
      row[x] = depth.at<float>(y, x);
      if (!at_edge(depth, x, y)) continue;
      const auto counter = 3U * static_cast<std::uint32_t>(y * depth.cols + x);
      const int dx = cvRound(scale * edge_shift * random.normal(counter));
      const int dy = cvRound(scale * edge_shift * random.normal(counter + 1));
      const bool hole = random.uniform(counter + 2) < edge_hole_share;
      row[x] = hole ? 0.0F
                    : depth.at<float>(std::clamp(y + dy, 0, depth.rows - 1),
                                      std::clamp(x + dx, 0, depth.cols - 1));
    }
    cast_shadows(focal_baseline, row, depth.cols);
    for (int x = 0; x < depth.cols; ++x) {
      if (row[x] <= 0.0F) continue;
      const bool faded = row[x] > all_seen + (none_seen - all_seen) * sight.at<float>(y, x);
      const float disparity = focal_baseline / row[x] + noise.at<float>(y, x);
      const float step = std::round(disparity * steps) / steps;
      const float measured = step > 0.0F ? focal_baseline / step : 0.0F;
      row[x] = !faded && measured >= from && measured <= to ? measured : 0.0F;
    }
  };
  cv::parallel_for_({0, depth.rows}, [&](const cv::Range& range) {
    for (int y = range.start; y < range.end; ++y) sense_row(y);
  });
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
