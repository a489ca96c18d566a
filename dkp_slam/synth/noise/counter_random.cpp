#include "dkp_slam/synth/noise/counter_random.h"

#include <array>
#include <cmath>

namespace dkp_slam {

const float* CounterRandom::normal_table() {
  static const auto table = [] {
    // Quantiles: the distribution function, inverted by halving.
    std::array<float, 4096> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(values.size());
      double low = -5.0, high = 5.0;
      for (int k = 0; k < 50; ++k) {
        const double middle = 0.5 * (low + high);
        (0.5 * std::erfc(-middle / std::sqrt(2.0)) < share ? low : high) = middle;
      }
      values[i] = static_cast<float>(0.5 * (low + high));
    }
    return values;
  }();
  return table.data();
}

}  // namespace dkp_slam
