#include "dkp_slam/feature/descriptor.h"

#include "dkp_slam/cpu.h"

namespace dkp_slam {
namespace {

int portable_distance(const Descriptor& a, const Descriptor& b) {
  int sum = 0;
  for (int i = 0; i < 4; ++i) sum += __builtin_popcountll(a[i] ^ b[i]);
  return sum;
}

DKP_SLAM_POPCNT int popcnt_distance(const Descriptor& a, const Descriptor& b) {
  return __builtin_popcountll(a[0] ^ b[0]) + __builtin_popcountll(a[1] ^ b[1]) +
         __builtin_popcountll(a[2] ^ b[2]) + __builtin_popcountll(a[3] ^ b[3]);
}

void offer(NearestTwo& nearest, int index, int distance) {
  if (distance < nearest.best_distance) {
    nearest.second = nearest.best;
    nearest.second_distance = nearest.best_distance;
    nearest.best = index;
    nearest.best_distance = distance;
  } else if (distance < nearest.second_distance) {
    nearest.second = index;
    nearest.second_distance = distance;
  }
}

DKP_SLAM_POPCNT NearestTwo popcnt_scan(const Descriptor& query, std::span<const Descriptor> pool) {
  NearestTwo nearest;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    offer(nearest, static_cast<int>(i), popcnt_distance(query, pool[i]));
  }
  return nearest;
}

DKP_SLAM_POPCNT NearestTwo popcnt_scan(const Descriptor& query, std::span<const Descriptor> pool,
                                       std::span<const int> candidates) {
  NearestTwo nearest;
  for (const int i : candidates) offer(nearest, i, popcnt_distance(query, pool[i]));
  return nearest;
}

}  // namespace

int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return have_popcnt() ? popcnt_distance(a, b) : portable_distance(a, b);
}

NearestTwo nearest_two(const Descriptor& query, std::span<const Descriptor> pool,
                       std::span<const int> candidates) {
  if (have_popcnt()) return popcnt_scan(query, pool, candidates);
  NearestTwo nearest;
  for (const int i : candidates) offer(nearest, i, portable_distance(query, pool[i]));
  return nearest;
}

NearestTwo nearest_two(const Descriptor& query, std::span<const Descriptor> pool) {
  if (have_popcnt()) return popcnt_scan(query, pool);
  NearestTwo nearest;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    offer(nearest, static_cast<int>(i), portable_distance(query, pool[i]));
  }
  return nearest;
}

}  // namespace dkp_slam
