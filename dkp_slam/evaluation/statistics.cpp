#include "dkp_slam/evaluation/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace dkp_slam {

double median(std::span<const double> values) {
  assert(!values.empty());
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t middle = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

ErrorStatistics summarise(std::span<const double> errors) {
  assert(!errors.empty());
  const double count = static_cast<double>(errors.size());
  ErrorStatistics statistics;
  statistics.count = errors.size();
  double sum = 0.0;
  double squares = 0.0;
  for (double error : errors) {
    sum += error;
    squares += error * error;
  }
  statistics.mean = sum / count;
  statistics.rmse = std::sqrt(squares / count);
  double deviations = 0.0;
  for (double error : errors) deviations += (error - statistics.mean) * (error - statistics.mean);
  statistics.deviation = std::sqrt(deviations / count);
  statistics.median = median(errors);
  const auto [min, max] = std::minmax_element(errors.begin(), errors.end());
  statistics.min = *min;
  statistics.max = *max;
  return statistics;
}

}  // namespace dkp_slam
