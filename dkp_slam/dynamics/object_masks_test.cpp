#include "dkp_slam/dynamics/object_masks.h"

#include <limits>

#include <gtest/gtest.h>

namespace dkp_slam {
namespace {

ObjectTracker::Tracked person(const cv::Rect2f& box) {
  ObjectTracker::Tracked t;
  t.object.class_id = 0;
  t.object.box = box;
  t.mask.mean_depth = 2.0F;
  return t;
}

/// Features in a row at x = 10, 30, 50, 70, 90, which were there in the frame before, too.
struct Row {
  std::vector<cv::Point2f> points;
  FeatureMotion motion;
  cv::Mat labels = cv::Mat::zeros(60, 100, CV_8UC1);
  Row() {
    for (int i = 0; i < 5; ++i) {
      points.emplace_back(10.0F + 20.0F * static_cast<float>(i), 30.0F);
      motion.residual.push_back(0.5F);
    }
    motion.tracks.previous = points;
  }
  std::vector<std::uint8_t> unmasked_in(const std::vector<ObjectTracker::Tracked>& objects) const {
    return unmasked(motion, points, objects, labels, 3.0);
  }
};

using Flags = std::vector<std::uint8_t>;

TEST(Unmasked, AreFeaturesInBoxesThatNoMaskHeldAndThatAgree) {
  Row row;
  const std::vector<ObjectTracker::Tracked> objects = {person({20, 0, 100, 60})};
  EXPECT_EQ(row.unmasked_in(objects), (Flags{0, 1, 1, 1, 1})) << "the first is in no box";
  row.labels(cv::Rect(20, 0, 20, 60)) = 1;
  row.motion.residual[2] = 4.0F;
  row.motion.residual[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(row.unmasked_in(objects), (Flags{0, 0, 0, 0, 1}));
  row.labels = cv::Mat();
  EXPECT_EQ(row.unmasked_in(objects), Flags(5, 0)) << "nothing is known of masks";
}

TEST(Unmasked, AreNoneWhereSomebodyMayHaveNoMask) {
  const Row row;
  ObjectTracker::Tracked moving = person({40, 0, 20, 60});
  moving.object.class_id = Detection::motion_class;
  ObjectTracker::Tracked fresh = person({60, 0, 20, 60});
  fresh.mask = {};
  EXPECT_EQ(row.unmasked_in({person({0, 0, 100, 60}), moving, fresh}), (Flags{1, 1, 0, 0, 1}));
  ObjectTracker::Tracked chair = person({0, 0, 100, 60});
  chair.object.moves_by_itself = false;
  EXPECT_EQ(row.unmasked_in({chair}), Flags(5, 0)) << "a chair's box is no question";
}

}  // namespace
}  // namespace dkp_slam
