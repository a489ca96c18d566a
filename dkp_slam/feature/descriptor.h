#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace dkp_slam {

/// A 256-bit binary descriptor (ORB).
using Descriptor = std::array<std::uint64_t, 4>;

/// Number of bits that differ, 0..256.
int hamming_distance(const Descriptor& a, const Descriptor& b);

/// The two nearest of some candidates.
struct NearestTwo {
  int best = -1;            ///< index into the pool; -1 when there was no candidate
  int best_distance = 257;  ///< above any real distance
  int second = -1;
  int second_distance = 257;
};

/// Nearest two of `pool[candidates[i]]` to `query`; the earlier candidate wins a tie.
NearestTwo nearest_two(const Descriptor& query, std::span<const Descriptor> pool,
                       std::span<const int> candidates);

/// Nearest two in the whole pool.
NearestTwo nearest_two(const Descriptor& query, std::span<const Descriptor> pool);

}  // namespace dkp_slam
