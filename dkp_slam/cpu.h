#pragma once

namespace dkp_slam {

// What the x86-64 baseline does not have and hot loops gain most from: without popcnt a distance of
// descriptors costs five times as much. Such loops exist twice, one marked with what it needs, and
// are chosen at run time.
#if defined(__x86_64__)
#define DKP_SLAM_POPCNT __attribute__((target("popcnt")))
#define DKP_SLAM_AVX2 __attribute__((target("avx2")))
#else
#define DKP_SLAM_POPCNT
#endif

/// Whether this machine can run what is marked DKP_SLAM_POPCNT.
inline bool have_popcnt() {
#if defined(__x86_64__)
  static const bool have = __builtin_cpu_supports("popcnt") != 0;
  return have;
#else
  return true;
#endif
}

/// Whether this machine can run what is marked DKP_SLAM_AVX2, which others cannot compile.
inline bool have_avx2() {
#if defined(__x86_64__)
  static const bool have = __builtin_cpu_supports("avx2") != 0;
  return have;
#else
  return false;
#endif
}

}  // namespace dkp_slam
