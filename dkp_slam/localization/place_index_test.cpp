#include "dkp_slam/localization/place_index.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

/// Keyframes whose features show landmarks, by appearance alone; geometry plays no part here.
struct PlaceIndexTest : ::testing::Test {
  Map map{Camera{}, 1.2F, 8};
  PlaceIndex places;
  std::mt19937_64 random{3};

  Descriptor random_descriptor() { return {random(), random(), random(), random()}; }
  std::vector<Descriptor> random_descriptors(std::size_t count) {
    std::vector<Descriptor> all(count);
    for (Descriptor& d : all) d = random_descriptor();
    return all;
  }
  /// Each bit turned with this probability.
  Descriptor noisy(Descriptor d, double share) {
    for (int bit = 0; bit < 256; ++bit) {
      if (double(random() >> 11) * 0x1p-53 < share) d[std::size_t(bit / 64)] ^= 1ULL << (bit % 64);
    }
    return d;
  }
  std::vector<Descriptor> noisy(std::vector<Descriptor> all, double share) {
    for (Descriptor& d : all) d = noisy(d, share);
    return all;
  }

  /// A keyframe that sees the landmarks given (and looks as they do), and new ones that look so.
  int add_keyframe(const std::vector<int>& known, const std::vector<Descriptor>& looks) {
    Keyframe k;
    for (const int l : known) {
      k.features.descriptor.push_back(map.landmark(l).descriptor);
      k.landmarks.push_back(l);
    }
    for (const Descriptor& d : looks) {
      k.features.descriptor.push_back(d);
      k.landmarks.push_back(-1);
    }
    const std::size_t features = k.landmarks.size();
    k.features.pixel.resize(features);
    k.features.level.resize(features);
    const int id = map.add_keyframe(std::move(k));
    for (std::size_t f = known.size(); f < features; ++f)
      map.add_landmark({0.0, 0.0, 1.0}, id, static_cast<int>(f));
    map.update_covisibility(id);
    places.add_keyframe(map, id);
    return id;
  }
  /// Two keyframes with 50 landmarks each; those of the first become those of the second.
  std::pair<int, int> add_fused_keyframes() {
    const int a = add_keyframe({}, random_descriptors(50));
    const int b = add_keyframe({}, random_descriptors(50));
    const std::vector<int> of_a = map.landmarks_of({a}), of_b = map.landmarks_of({b});
    for (std::size_t i = 0; i < 50; ++i) map.fuse_landmarks(of_a[i], of_b[i]);
    return {a, b};
  }
  const std::vector<Descriptor>& looks_of(int keyframe) const {
    return map.keyframe(keyframe).features.descriptor;
  }
};

TEST_F(PlaceIndexTest, EveryLandmarkInViewIsAVote) {
  const int a = add_keyframe({}, random_descriptors(100));
  const std::vector<int> of_a = map.landmarks_of({a});
  const int b = add_keyframe({of_a.begin(), of_a.begin() + 40}, random_descriptors(60));
  const auto votes = places.votes(map, looks_of(b));
  ASSERT_EQ(votes.size(), 2U);
  EXPECT_EQ(votes[0].keyframe, a);
  EXPECT_EQ(votes[0].votes, 40);
  EXPECT_EQ(votes[1].keyframe, b);
  EXPECT_EQ(votes[1].votes, 100);
  // What both see says less than what one sees: weights log(1 + 2 / 2) and log(1 + 2 / 1).
  EXPECT_NEAR(votes[0].score, 40 * std::log(2.0), 1e-9);
  EXPECT_NEAR(votes[1].score, 40 * std::log(2.0) + 60 * std::log(3.0), 1e-9);
}

TEST_F(PlaceIndexTest, FindsTheRightOneOfManyPlacesUnderNoise) {
  std::vector<int> keyframes;
  for (int place = 0; place < 60; ++place) {
    const int first = add_keyframe({}, random_descriptors(200));
    keyframes.push_back(first);
    add_keyframe(map.landmarks_of({first}), random_descriptors(50));
  }
  for (const int k : {keyframes[0], keyframes[31], keyframes[59]}) {
    // Half of the view is new, and in the rest one bit in eight is wrong.
    std::vector<Descriptor> view = noisy(looks_of(k), 1.0 / 8.0);
    const std::vector<Descriptor> clutter = random_descriptors(200);
    view.insert(view.end(), clutter.begin(), clutter.end());
    const auto found = places.query(map, view, 5);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found[0].keyframe / 2, k / 2);
    EXPECT_GT(found[0].votes, 80);
    EXPECT_LE(found.size(), 2U);  // of the same place
  }
}

TEST_F(PlaceIndexTest, AnUnknownPlaceHasNoCandidates) {
  EXPECT_TRUE(places.query(map, random_descriptors(500), 5).empty());
  for (int place = 0; place < 20; ++place) add_keyframe({}, random_descriptors(200));
  EXPECT_TRUE(places.query(map, random_descriptors(500), 5).empty());
  EXPECT_TRUE(places.query(map, {}, 5).empty());
}

TEST_F(PlaceIndexTest, ARemovedKeyframeHasNoVotes) {
  const int a = add_keyframe({}, random_descriptors(100));
  const std::vector<Descriptor> looks = looks_of(a);
  const int b = add_keyframe(map.landmarks_of({a}), {});
  ASSERT_EQ(map.keyframe(b).parent, a);
  map.remove_keyframe(b);
  const auto votes = places.votes(map, looks);
  ASSERT_EQ(votes.size(), 1U);
  EXPECT_EQ(votes[0].keyframe, a);
}

TEST_F(PlaceIndexTest, EntriesOfLostLandmarksAreClearedAway) {
  const int a = add_keyframe({}, random_descriptors(100));
  const std::vector<Descriptor> looks = looks_of(a);
  EXPECT_EQ(places.size(), 100U);
  for (const int l : map.landmarks_of({a})) map.remove_landmark(l);
  EXPECT_TRUE(places.votes(map, looks).empty());
  add_keyframe({}, random_descriptors(10));
  EXPECT_EQ(places.size(), 10U);
  add_keyframe({}, random_descriptors(90));
  EXPECT_EQ(places.size(), 100U);
}

TEST_F(PlaceIndexTest, MemoryFollowsTheLandmarksThatAreThere) {
  std::size_t early = 0;
  for (int k = 0; k < 300; ++k) {
    const int id = add_keyframe({}, random_descriptors(100));
    if (k == 50) early = places.memory();
    for (const int l : map.landmarks_of({id})) map.remove_landmark(l);
  }
  EXPECT_EQ(places.size(), 100U);
  EXPECT_LT(places.memory() - early, 20000U);  // of 25000 landmarks that came and went
}

TEST_F(PlaceIndexTest, FusionsHaveBeenFollowedAfterARoundOfTidying) {
  const auto [a, b] = add_fused_keyframes();
  const std::vector<Descriptor> looks = looks_of(a);
  EXPECT_EQ(places.followed_fusions(), 0);
  for (int k = 0; k < 3; ++k) places.add_keyframe(map, b);
  ASSERT_EQ(places.followed_fusions(), 50);
  const auto before = places.votes(map, looks);
  map.forget_fusions(places.followed_fusions());
  const auto votes = places.votes(map, looks);
  ASSERT_EQ(votes.size(), before.size());
  EXPECT_EQ(votes[0].votes, 50);
}

TEST_F(PlaceIndexTest, ALandmarkLooksLikeThoseThatBecameIt) {
  const auto [a, b] = add_fused_keyframes();
  const std::vector<Descriptor> looks = looks_of(a);
  for (int before_and_after_tidying = 0; before_and_after_tidying < 2; ++before_and_after_tidying) {
    const auto votes = places.votes(map, looks);
    ASSERT_EQ(votes.size(), 2U);
    EXPECT_EQ(votes[0].votes, 50);
    EXPECT_EQ(votes[1].votes, 50);
    EXPECT_EQ(places.size(), 100U);
    places.add_keyframe(map, b);
  }
}

TEST_F(PlaceIndexTest, ALandmarkHasFewLooks) {
  const int first = add_keyframe({}, {random_descriptor()});
  const std::vector<int> landmark = map.landmarks_of({first});
  const std::vector<Descriptor> looks = random_descriptors(3);
  for (const Descriptor& look : looks) {
    const int k = add_keyframe({}, {look});
    map.fuse_landmarks(map.landmarks_of({k})[0], landmark[0]);
    places.add_keyframe(map, k);
  }
  EXPECT_EQ(places.size(), 3U);  // the last finds no room
  add_keyframe(landmark, {});
  EXPECT_EQ(places.size(), 3U);  // nothing new about it
  EXPECT_EQ(places.votes(map, looks).size(), 5U);
}

TEST_F(PlaceIndexTest, WhatLooksLikeEverythingIsPassedOver) {
  const Descriptor common = random_descriptor();
  std::vector<Descriptor> wall = random_descriptors(20);
  for (int k = 0; k < 15; ++k) {
    add_keyframe({}, std::vector<Descriptor>(20, common));
  }
  // 300 landmarks in one bucket are more than are looked at.
  EXPECT_TRUE(places.votes(map, std::vector<Descriptor>{common}).empty());
  const int k = add_keyframe({}, wall);
  wall.push_back(common);
  const auto found = places.query(map, wall, 5);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].keyframe, k);
}

TEST_F(PlaceIndexTest, NeighboursVoteForOneAnother) {
  // A view of 60 features: a keyframe elsewhere shares 32 of them, each of three neighbours 30.
  const std::vector<Descriptor> view = random_descriptors(62);
  const int lone = add_keyframe({}, {view.begin(), view.begin() + 32});
  const int first = add_keyframe({}, {view.begin() + 32, view.end()});
  const std::vector<int> shared = map.landmarks_of({first});
  add_keyframe(shared, random_descriptors(5));
  add_keyframe(shared, random_descriptors(5));
  const auto votes = places.votes(map, view);
  EXPECT_EQ(votes[0].keyframe, lone);
  EXPECT_EQ(votes[0].votes, 32);
  const auto found = places.query(map, view, 5);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].keyframe, lone);
  EXPECT_EQ(found[0].votes, 30);
  EXPECT_GT(found[0].group_score, votes[0].score);
}

}  // namespace
}  // namespace dkp_slam
