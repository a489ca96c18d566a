#include "dkp_slam/dense/keyframe_fusion.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "dkp_slam/dense/surface_extraction.h"
#include "dkp_slam/dense/test_views.h"
#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using testing::both;
using testing::box;
using testing::Scene;
using testing::seen;
using testing::small_camera;

const AlignedBox3d walls(Vector3d(-1.6, -1.1, -1.4), Vector3d(1.5, 1.0, 1.7));
const AlignedBox3d cupboard(Vector3d(0.7, -0.2, 0.6), Vector3d(1.2, 0.9, 1.3));
constexpr int round_trip = 20;

/// The walls as they are seen from within.
Scene inside(const AlignedBox3d& box) {
  return [box](const Vector3d& o, const Vector3d& d) {
    double out = INFINITY;
    for (int i = 0; i < 3; ++i) {
      if (d[i] != 0.0) out = std::min(out, ((d[i] > 0.0 ? box.max() : box.min())[i] - o[i]) / d[i]);
    }
    return out;
  };
}

Scene room() { return both(inside(walls), box(cupboard)); }

/// Distance from what there is in the room.
double from_room(const Vector3d& p) {
  const auto from_box = [&](const AlignedBox3d& b) {
    const double outside = b.exteriorDistance(p);
    const double inside =
        std::min((p - b.min()).cwiseAbs().minCoeff(), (p - b.max()).cwiseAbs().minCoeff());
    return outside > 0.0 ? outside : inside;
  };
  return std::min(from_box(walls), from_box(cupboard));
}

double mean_error(const KeyframeFusion& fusion) {
  SurfaceOptions options;
  options.least_views = 1.0;
  const SurfaceMesh mesh = extract_surface(fusion.map(), options);
  EXPECT_GT(mesh.vertices.size(), 5000U);
  double sum = 0.0;
  for (const auto& v : mesh.vertices) sum += from_room(v.cast<double>());
  return sum / double(mesh.vertices.size());
}

/// The i-th of the poses of a camera that turns round in the room.
Se3 true_pose(int i) {
  const double a = 2.0 * M_PI * i / round_trip;
  return {Eigen::Quaterniond(Eigen::AngleAxisd(a, Vector3d::UnitY())),
          {0.3 * std::sin(a), 0.02 * std::sin(3.0 * a), -0.3 + 0.3 * std::cos(a)}};
}

/// The same with the error that has grown until the loop is closed: 15 cm and 5 degrees.
Se3 drifted_pose(int i) {
  const double share = double(i) / round_trip;
  const Se3 error(Eigen::Quaterniond(Eigen::AngleAxisd(0.09 * share, Vector3d::UnitY())),
                  share * Vector3d(0.1, 0.03, -0.1));
  return error * true_pose(i);
}

std::shared_ptr<const KeyframeImage> image(int i, const Scene& scene, bool masked = false) {
  RgbdFrame frame = seen(small_camera(), scene, true_pose(i));
  frame.timestamp = i;
  cv::Mat mask;
  if (masked) mask = frame.depth < 1.0F;
  return std::make_shared<const KeyframeImage>(keep_image(frame, mask, small_camera()));
}

std::vector<PosedImage> keyframes_of_room() {
  std::vector<PosedImage> keyframes;
  for (int i = 0; i < round_trip; ++i) keyframes.push_back({i, drifted_pose(i), image(i, room())});
  return keyframes;
}

KeyframeFusionOptions options(double moved) {
  KeyframeFusionOptions options;
  options.moved = moved;
  options.map.voxel = 0.03;
  return options;
}

KeyframeFusion at_once(const std::vector<PosedImage>& keyframes, double moved) {
  KeyframeFusion fusion(small_camera(), options(moved));
  EXPECT_TRUE(fusion.update(keyframes));
  return fusion;
}

bool has_something(const BlockGrid<Voxel>::Block& block) {
  const BlockGrid<Voxel>::Block nothing{};
  return std::memcmp(block.data(), nothing.data(), sizeof(block)) != 0;
}

/// All blocks with something in them are in both and hold the same bytes; free space as well.
void expect_same(const KeyframeFusion& a, const KeyframeFusion& b) {
  for (const auto& [one, other] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    const auto& grid = one->map().voxels();
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (!has_something(grid.block(i))) continue;
      const auto* same = other->map().voxels().find(grid.place(i));
      ASSERT_NE(same, nullptr) << grid.place(i).transpose();
      ASSERT_EQ(std::memcmp(same, &grid.block(i), sizeof(*same)), 0) << grid.place(i).transpose();
    }
    const auto& free = one->free()->grid();
    for (std::size_t i = 0; i < free.size(); ++i) {
      for (int c = 0; c < FreeSpace::Cells::cells; ++c) {
        const Eigen::Vector3i cell = free.place(i) * 8 + Eigen::Vector3i(c & 7, c >> 3 & 7, c >> 6);
        ASSERT_EQ(other->free()->views(cell), free.block(i)[std::size_t(c)]);
      }
    }
  }
}

TEST(KeyframeFusion, AClosedLoopMovesWhatWasFused) {
  std::vector<PosedImage> keyframes = keyframes_of_room();
  KeyframeFusion fusion(small_camera(), options(0.5));
  for (int n = 1; n <= round_trip; ++n) {
    ASSERT_TRUE(fusion.update(std::span(keyframes).first(std::size_t(n))));
  }
  EXPECT_EQ(fusion.fused_again(), 0);
  EXPECT_GT(mean_error(fusion), 0.03);
  for (PosedImage& k : keyframes) k.world_from_camera = true_pose(k.id);
  ASSERT_TRUE(fusion.update(keyframes));
  EXPECT_GT(fusion.fused_again(), round_trip / 2);
  EXPECT_LT(mean_error(fusion), 0.006);
  EXPECT_LT(std::abs(mean_error(fusion) - mean_error(at_once(keyframes, 0.0))), 0.003);
}

TEST(KeyframeFusion, WhateverKeyframesDidTheMapIsThatOfWhereTheyAre) {
  std::vector<PosedImage> keyframes = keyframes_of_room();
  KeyframeFusion fusion(small_camera(), options(0.0));
  for (const int n : {3, 4, 12, round_trip}) {
    ASSERT_TRUE(fusion.update(std::span(keyframes).first(std::size_t(n))));
  }
  expect_same(fusion, at_once(keyframes, 0.0));
  // A few move, which is put right in their blocks alone.
  for (const std::size_t i : {6U, 7U, 8U}) keyframes[i].world_from_camera = true_pose(int(i));
  ASSERT_TRUE(fusion.update(keyframes));
  EXPECT_EQ(fusion.fused_again(), 3);
  expect_same(fusion, at_once(keyframes, 0.0));
  // One goes, and comes back among the others.
  const PosedImage gone = keyframes[10];
  keyframes.erase(keyframes.begin() + 10);
  ASSERT_TRUE(fusion.update(keyframes));
  expect_same(fusion, at_once(keyframes, 0.0));
  keyframes.insert(keyframes.begin() + 10, gone);
  ASSERT_TRUE(fusion.update(keyframes));
  expect_same(fusion, at_once(keyframes, 0.0));
  // All of them move: a loop is closed.
  for (PosedImage& k : keyframes) k.world_from_camera = true_pose(k.id);
  ASSERT_TRUE(fusion.update(keyframes));
  expect_same(fusion, at_once(keyframes, 0.0));
  ASSERT_EQ(fusion.path().size(), std::size_t{round_trip});
  EXPECT_EQ(fusion.path()[3].timestamp, 3.0);
  ASSERT_TRUE(fusion.update({}));
  EXPECT_EQ(fusion.map().voxels().size(), 0U);
}

TEST(KeyframeFusion, LessThanTheBoundMovesNothing) {
  std::vector<PosedImage> keyframes = keyframes_of_room();
  KeyframeFusion fusion = at_once(keyframes, 0.5);
  for (PosedImage& k : keyframes) {
    k.world_from_camera = Se3({1.0, 0.0, 0.0, 0.0}, {0.014, 0.0, 0.0}) * k.world_from_camera;
  }
  ASSERT_TRUE(fusion.update(keyframes));
  EXPECT_EQ(fusion.fused_again(), 0);
  for (PosedImage& k : keyframes) {
    k.world_from_camera = Se3({1.0, 0.0, 0.0, 0.0}, {0.002, 0.0, 0.0}) * k.world_from_camera;
  }
  ASSERT_TRUE(fusion.update(keyframes));
  EXPECT_EQ(fusion.fused_again(), round_trip) << "small steps add up";
}

TEST(KeyframeFusion, WhatLiesInMasksNeverEntersWhereverKeyframesGo) {
  const auto guest_at = [](int i) {
    const Vector3d middle = true_pose(i) * Vector3d(0.0, 0.0, 0.8);
    return AlignedBox3d(middle.array() - 0.12, middle.array() + 0.12);
  };
  std::vector<PosedImage> keyframes;
  for (int i = 0; i < round_trip; ++i) {
    keyframes.push_back({i, drifted_pose(i), image(i, both(room(), box(guest_at(i))), true)});
  }
  KeyframeFusion fusion = at_once(keyframes, 0.5);
  for (PosedImage& k : keyframes) k.world_from_camera = true_pose(k.id);
  ASSERT_TRUE(fusion.update(keyframes));
  SurfaceOptions all;
  all.least_views = 1.0;
  const SurfaceMesh mesh = extract_surface(fusion.map(), all);
  EXPECT_GT(mesh.vertices.size(), 3000U);
  long guests = 0;
  for (const auto& v : mesh.vertices) guests += from_room(v.cast<double>()) > 0.06;
  EXPECT_EQ(guests, 0);
}

TEST(KeyframeFusion, MasksDoNotGrowWithEveryTimeTheyAreUsed) {
  for (const double k1 : {0.0, 0.2}) {
    Camera camera = small_camera();
    camera.distortion.k1 = k1;
    RgbdFrame frame = seen(camera, testing::wall(2.0));
    frame.mask = cv::Mat::zeros(frame.depth.size(), CV_8UC1);
    frame.mask(cv::Rect(60, 40, 20, 20)) = 255;
    const cv::Mat before = frame.mask.clone();
    DepthViewer(camera).view(frame, {});
    EXPECT_EQ(cv::countNonZero(before != frame.mask), 0) << k1;
  }
}

TEST(KeyframeFusion, EndsWhenItIsStopped) {
  const std::vector<PosedImage> keyframes = keyframes_of_room();
  KeyframeFusion fusion(small_camera(), options(0.5));
  const std::atomic<bool> stop{true};
  EXPECT_FALSE(fusion.update(keyframes, &stop));
}

TEST(KeyframeImage, IsSmallAndKeepsMasksAndDepth) {
  Camera camera = small_camera();
  const Camera kept = kept_camera(camera, 80);
  EXPECT_EQ(kept.width, 80);
  EXPECT_EQ(kept.height, 60);
  EXPECT_EQ(kept_camera(camera, 100).width, 160) << "only whole fractions";
  RgbdFrame frame = seen(camera, testing::wall(2.3456));
  frame.depth.at<float>(0, 0) = 0.0F;
  cv::Mat mask = cv::Mat::zeros(frame.depth.size(), CV_8UC1);
  mask.at<std::uint8_t>(41, 31) = 1;
  const KeyframeImage image = keep_image(frame, mask, kept);
  const RgbdFrame again = frame_of(image);
  EXPECT_EQ(again.depth.at<float>(0, 0), 0.0F);
  EXPECT_NEAR(again.depth.at<float>(30, 40), 2.3456, 0.0002);
  EXPECT_NEAR(image.farthest, 2.3456, 0.0002);
  EXPECT_EQ(cv::countNonZero(again.mask), 1);
  EXPECT_NE(again.mask.at<std::uint8_t>(20, 15), 0);
  EXPECT_TRUE(keep_image(frame, {}, kept).mask.empty());
}

}  // namespace
}  // namespace dkp_slam
