#include "dkp_slam/calibration/profile.h"

#include <algorithm>
#include <cmath>

namespace dkp_slam {
namespace {

constexpr int row_bins = 24, rate_bins = 16;
constexpr double most_rate = 0.4;  // 1/(metre second)
// Sightings that are wrong altogether say nothing of times.
constexpr double most_pixels = 4.0, most_inverse = 0.05;

struct Sum {
  double value = 0.0, weight = 0.0, squares = 0.0;
  int count = 0;
};

}  // namespace

std::vector<ProfileBin> row_profile(const std::vector<Window>& windows,
                                    const Parameters& parameters) {
  std::vector<Sum> sums(row_bins);
  for (const Window& window : windows) {
    for (const WindowPoint& point : window.points) {
      for (const TimedSighting& seen : point.seen) {
        const auto term = pixel_error(window.motion, point.position, seen, parameters, false);
        if (!term.valid || term.error.norm() > most_pixels * seen.sigma) continue;
        const int bin = std::clamp(static_cast<int>((seen.row + 0.5) * row_bins), 0, row_bins - 1);
        // The error is left at the moment that the parameters say; a lag is counted from the
        // middle row.
        const double weight = 1.0 / (seen.sigma * seen.sigma);
        const double speed = term.by_time.squaredNorm();
        Sum& sum = sums[static_cast<std::size_t>(bin)];
        sum.value += weight * (seen.row * parameters[readout_parameter] * speed -
                               term.error.dot(term.by_time));
        sum.weight += weight * speed;
        sum.squares += weight * term.error.squaredNorm() / 2.0;
        ++sum.count;
      }
    }
  }
  std::vector<ProfileBin> bins;
  for (int i = 0; i < row_bins; ++i) {
    const Sum& s = sums[static_cast<std::size_t>(i)];
    if (s.count < 20 || s.weight <= 0.0) continue;
    bins.push_back({(i + 0.5) / row_bins - 0.5, s.value / s.weight,
                    std::sqrt(s.squares / s.count / s.weight)});
  }
  return bins;
}

std::vector<ProfileBin> depth_profile(const std::vector<Window>& windows,
                                      const Parameters& parameters) {
  std::vector<Sum> sums(rate_bins);
  for (const Window& window : windows) {
    for (const WindowPoint& point : window.points) {
      for (const TimedSighting& seen : point.seen) {
        if (!seen.depth.known()) continue;
        const auto term = depth_error(window.motion, point.position, seen, parameters, false);
        if (!term.valid || std::abs(term.error[0]) > most_inverse) continue;
        const double rate = term.by_time[0];
        const int bin = static_cast<int>((rate / most_rate + 1.0) / 2.0 * rate_bins);
        if (bin < 0 || bin >= rate_bins) continue;
        const double value = rate * parameters[delay_parameter] - term.error[0];
        Sum& sum = sums[static_cast<std::size_t>(bin)];
        sum.value += value;
        sum.squares += value * value;
        ++sum.count;
      }
    }
  }
  std::vector<ProfileBin> bins;
  for (int i = 0; i < rate_bins; ++i) {
    const Sum& s = sums[static_cast<std::size_t>(i)];
    if (s.count < 20) continue;
    const double mean = s.value / s.count;
    bins.push_back({((i + 0.5) / rate_bins * 2.0 - 1.0) * most_rate, mean,
                    std::sqrt(std::max(0.0, s.squares / s.count - mean * mean) / s.count)});
  }
  return bins;
}

}  // namespace dkp_slam
