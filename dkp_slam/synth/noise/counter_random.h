#pragma once

#include <cstdint>

namespace dkp_slam {

/// Random numbers by position instead of by order, so that any number of threads draw the same:
/// the finalizer of Wellons' "hash prospector" (lowbias32) over seed and counter.
class CounterRandom {
 public:
  explicit CounterRandom(std::uint64_t seed)
      : key_(mix(static_cast<std::uint32_t>(seed) ^
                 mix(static_cast<std::uint32_t>(seed >> 32U) + 0x9E3779B9U))) {}

  std::uint32_t bits(std::uint32_t counter) const { return mix(mix(counter ^ key_) + key_); }
  /// 0 to below 1.
  float uniform(std::uint32_t counter) const {
    return static_cast<float>(bits(counter) >> 8U) * 0x1p-24F;
  }
  /// Mean 0, standard deviation 1, out of 4096 values.
  float normal(std::uint32_t counter) const { return normal_table()[bits(counter) >> 20U]; }

 private:
  static std::uint32_t mix(std::uint32_t x) {
    x = (x ^ (x >> 16U)) * 0x7FEB352DU;
    x = (x ^ (x >> 15U)) * 0x846CA68BU;
    return x ^ (x >> 16U);
  }
  static const float* normal_table();

  std::uint32_t key_;
};

}  // namespace dkp_slam
