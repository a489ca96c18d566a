#pragma once

#include <cstddef>
#include <span>

namespace dkp_slam {

/// The six figures of the TUM RGB-D benchmark for a set of errors, in the errors' unit.
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;     ///< mean of the two middle ones for an even count
  double deviation = 0.0;  ///< standard deviation of the population (divided by count)
  double min = 0.0;
  double max = 0.0;
};

/// Statistics of at least one error.
ErrorStatistics summarise(std::span<const double> errors);

/// Median of at least one value; mean of the two middle ones for an even count.
double median(std::span<const double> values);

}  // namespace dkp_slam
