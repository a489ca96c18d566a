#include "dkp_slam/sensor/synthetic/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/synthetic/motion.h"
#include "dkp_slam/sensor/synthetic/source.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Built once: making the textures takes longer than most tests.
const SyntheticWorld& world() {
  static const SyntheticWorld instance(1, 2);
  return instance;
}

const Camera& camera() {
  static const Camera instance = SyntheticOptions::default_camera();
  return instance;
}

TEST(SyntheticWorld, DepthOfTheCeilingIsAnalytic) {
  const RoomSize room;
  // Straight up, then tilted by 20 degrees about the camera's x axis.
  for (const double tilt : {0.0, 20.0 * std::numbers::pi / 180.0}) {
    const Eigen::AngleAxisd turn(tilt, Vector3d::UnitX());
    const Se3 pose(Eigen::Quaterniond(turn), {0.2, -0.5, 1.9});
    const Rendering seen = world().render(camera(), pose, 0.0);
    int checked = 0;
    for (int y = 0; y < camera().height; y += 7) {
      for (int x = 0; x < camera().width; x += 7) {
        const Vector3d ray = pose.rotation * camera().unproject(Vector2d(x, y), 1.0);
        const Vector3d hit = pose.translation + (room.height - 1.9) / ray.z() * ray;
        const bool on_ceiling = ray.z() > 0.0 && hit.x() > room.left && hit.x() < room.right &&
                                hit.y() > room.back && hit.y() < room.front;
        if (!on_ceiling) continue;
        ++checked;
        ASSERT_NEAR(seen.depth.at<float>(y, x), (room.height - 1.9) / ray.z(), 1e-5);
      }
    }
    EXPECT_GT(checked, 3000);
  }
}

/// The whole scene again, shape by shape, without any bounds or short cuts.
TEST(SyntheticWorld, DepthAndMaskAreThoseOfTheNearestShape) {
  constexpr std::uint64_t seed = 1;
  cv::RNG room_rng(seed * 2 + 1);
  const std::vector<Panel> room = build_room(room_rng);
  cv::RNG people_rng(seed * 2 + 2);
  WalkingLoop loop;
  loop.start = 1.05 * std::numbers::pi;
  const Person person(people_rng, loop);
  const SyntheticWorld one_person(seed, 1);

  const double time = 2.0;
  const Se3 pose = camera_pose(SyntheticMotion::halfsphere, seed, time);
  const Se3 camera_from_world = pose.inverse();
  const Rendering seen = one_person.render(camera(), pose, time);
  int dynamic = 0;
  for (int y = 0; y < camera().height; y += 3) {
    for (int x = 0; x < camera().width; x += 3) {
      const Vector3d ray = camera().unproject(Vector2d(x, y), 1.0);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Panel& panel : room) {
        nearest = std::min(nearest, intersect(camera_from_world * panel, ray).value_or(nearest));
      }
      bool is_person = false;
      for (const Solid& part : person.at(time)) {
        const auto t = intersect(camera_from_world * part, ray);
        if (t && *t < nearest) {
          nearest = *t;
          is_person = true;
        }
      }
      dynamic += is_person;
      ASSERT_EQ(seen.mask.at<std::uint8_t>(y, x), is_person ? 255 : 0) << x << " " << y;
      ASSERT_NEAR(seen.depth.at<float>(y, x), nearest, 1e-5) << x << " " << y;
    }
  }
  EXPECT_GT(dynamic, 1000);
}

TEST(SyntheticWorld, StaticPointsAgreeBetweenFramesUnderTheTruePoses) {
  const Se3 pose_a = camera_pose(SyntheticMotion::xyz, 1, 3.0);
  const Se3 pose_b = camera_pose(SyntheticMotion::xyz, 1, 3.4);
  ASSERT_GT((pose_a.inverse() * pose_b).translation.norm(), 0.03);
  const Rendering a = world().render(camera(), pose_a, 3.0);
  const Rendering b = world().render(camera(), pose_b, 3.4);
  const Se3 b_from_a = pose_b.inverse() * pose_a;
  std::vector<double> depth_gaps, grey_gaps;
  cv::Mat grey_a, grey_b;
  cv::cvtColor(a.colour, grey_a, cv::COLOR_BGR2GRAY);
  cv::cvtColor(b.colour, grey_b, cv::COLOR_BGR2GRAY);
  for (int y = 2; y < camera().height; y += 3) {
    for (int x = 2; x < camera().width; x += 3) {
      if (a.mask.at<std::uint8_t>(y, x) != 0) continue;
      const Vector3d p = b_from_a * camera().unproject(Vector2d(x, y), a.depth.at<float>(y, x));
      const Vector2d pixel = camera().project(p);
      const cv::Point at(cvFloor(pixel.x()), cvFloor(pixel.y()));
      if (at.x < 0 || at.y < 0 || at.x + 1 >= camera().width || at.y + 1 >= camera().height) {
        continue;
      }
      const cv::Rect four(at.x, at.y, 2, 2);
      if (cv::countNonZero(b.mask(four)) > 0) continue;
      double low = 0.0, high = 0.0;
      cv::minMaxLoc(b.depth(four), &low, &high);
      // Occluded in b, or at the edge of a surface.
      if (high - low > 0.02 * low || p.z() > high + 0.05) continue;
      const cv::Point2f centre(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
      cv::Mat depth, grey;
      cv::getRectSubPix(grey_b, {1, 1}, centre, grey);
      // Inverse depth is what is linear across a plane's image.
      const double fx = pixel.x() - at.x, fy = pixel.y() - at.y;
      const auto inverse = [&](int dx, int dy) {
        return 1.0 / b.depth.at<float>(at.y + dy, at.x + dx);
      };
      const double top = inverse(0, 0) * (1 - fx) + inverse(1, 0) * fx;
      const double bottom = inverse(0, 1) * (1 - fx) + inverse(1, 1) * fx;
      depth_gaps.push_back(std::abs(1.0 / (top * (1 - fy) + bottom * fy) - p.z()));
      grey_gaps.push_back(std::abs(grey.at<std::uint8_t>(0, 0) - grey_a.at<std::uint8_t>(y, x)));
    }
  }
  ASSERT_GT(depth_gaps.size(), 15000U);
  std::sort(depth_gaps.begin(), depth_gaps.end());
  std::sort(grey_gaps.begin(), grey_gaps.end());
  EXPECT_LT(depth_gaps[depth_gaps.size() * 95 / 100], 1e-4);
  EXPECT_LE(grey_gaps[grey_gaps.size() / 2], 2.0);
  EXPECT_LE(grey_gaps[grey_gaps.size() * 9 / 10], 10.0);
}

TEST(SyntheticWorld, PeopleMoveAndTheRoomDoesNot) {
  const Se3 pose = camera_pose(SyntheticMotion::still, 1, 0.0);
  const Rendering before = world().render(camera(), pose, 2.0);
  const Rendering after = world().render(camera(), pose, 2.5);
  const cv::Mat moved = (before.depth != after.depth);
  const cv::Mat people = before.mask | after.mask;
  EXPECT_GT(cv::countNonZero(moved), 5000);
  EXPECT_EQ(cv::countNonZero(moved & ~people), 0);
  // Colours may differ two pixels around the masks as well, where edges are averaged over rays that
  // need not hit what the pixel's centre hits; nowhere else.
  cv::Mat near_people, difference, changed;
  cv::dilate(people, near_people, cv::Mat::ones(5, 5, CV_8U));
  cv::absdiff(before.colour, after.colour, difference);
  cv::cvtColor(difference, changed, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(cv::countNonZero((changed > 0) & ~near_people), 0);
}

TEST(SyntheticWorld, ManySpreadFeaturesEverywhereOnEveryPath) {
  for (const SyntheticMotion motion :
       {SyntheticMotion::xyz, SyntheticMotion::halfsphere, SyntheticMotion::still}) {
    const Rendering seen = world().render(camera(), camera_pose(motion, 1, 6.0), 6.0);
    std::vector<cv::KeyPoint> keypoints;
    cv::FAST(seen.colour, keypoints, 20);
    std::vector<int> cells(8 * 6, 0);
    for (const cv::KeyPoint& k : keypoints) {
      ++cells[static_cast<std::size_t>(static_cast<int>(k.pt.y / 80) * 8 +
                                       static_cast<int>(k.pt.x / 80))];
    }
    EXPECT_GT(keypoints.size(), 800U);
    EXPECT_GE(std::count_if(cells.begin(), cells.end(), [](int n) { return n >= 3; }), 36);
  }
}

TEST(SyntheticWorld, RefusesWhatItCannotRender) {
  Camera distorted = camera();
  distorted.distortion.k1 = 0.1;
  EXPECT_THROW(world().render(distorted, Se3(), 0.0), Error);
  EXPECT_THROW(SyntheticWorld(1, -1), Error);
}

}  // namespace
}  // namespace dkp_slam
