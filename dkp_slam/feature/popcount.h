#pragma once

namespace dkp_slam {

// The popcnt instruction is not in the x86-64 baseline, and without it a distance costs five times
// as much; so hot loops over bits exist twice, one marked DKP_SLAM_POPCNT, and are chosen at run
// time.
#if defined(__x86_64__)
#define DKP_SLAM_POPCNT __attribute__((target("popcnt")))
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

}  // namespace dkp_slam
