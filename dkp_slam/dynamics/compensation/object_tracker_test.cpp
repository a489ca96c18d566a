#include "dkp_slam/dynamics/compensation/object_tracker.h"

#include <gtest/gtest.h>

#include "tests/support/vga_camera.h"

namespace dkp_slam {
namespace {

const cv::Size image(640, 480);

Detection person(float x, float score, float y = 100.0F) {
  Detection d;
  d.box = {x, y, 100.0F, 250.0F};
  d.class_id = 0;
  d.score = score;
  return d;
}

/// A frame whose own detections are known.
void update(ObjectTracker& tracker, double time, const std::vector<Detection>& detections,
            const std::vector<std::optional<cv::Point2f>>& flow) {
  tracker.update(time, image, {time, true, detections}, flow);
}

TEST(ObjectTracker, StartsAboveOneScoreAndContinuesAboveALowerOne) {
  ObjectTracker tracker({});
  update(tracker, 0.0, {person(200, 0.2F)}, {});
  EXPECT_TRUE(tracker.objects().empty());
  update(tracker, 0.1, {person(200, 0.5F)}, {});
  ASSERT_EQ(tracker.objects().size(), 1U);
  const int id = tracker.objects()[0].object.id;
  update(tracker, 0.2, {person(210, 0.12F)}, {});
  ASSERT_EQ(tracker.objects().size(), 1U);
  EXPECT_EQ(tracker.objects()[0].object.id, id);
  EXPECT_FALSE(tracker.objects()[0].object.compensated);
  EXPECT_FLOAT_EQ(tracker.objects()[0].object.box.x, 210.0F);
}

TEST(ObjectTracker, CarriesABoxThroughABurstOfMissesByTheFlow) {
  ObjectTracker tracker({});
  update(tracker, 0.0, {person(200, 0.8F)}, {});
  for (int i = 1; i <= 30; ++i) {  // a second without detections, 4 px a frame
    update(tracker, i / 30.0, {}, {cv::Point2f(4.0F, 0.0F)});
    ASSERT_EQ(tracker.objects().size(), 1U) << i;
    EXPECT_TRUE(tracker.objects()[0].object.compensated);
    EXPECT_NEAR(tracker.objects()[0].object.box.x, 200.0F + 4.0F * static_cast<float>(i), 1e-2F);
  }
  update(tracker, 31 / 30.0, {person(330, 0.6F)}, {cv::Point2f(4.0F, 0.0F)});
  ASSERT_EQ(tracker.objects().size(), 1U);
  EXPECT_EQ(tracker.objects()[0].object.id, 1);
  EXPECT_FALSE(tracker.objects()[0].object.compensated);
}

TEST(ObjectTracker, GivesUpAfterATimeWhateverTheFrameRate) {
  for (const double rate : {10.0, 30.0, 60.0}) {
    ObjectTracker tracker({});
    update(tracker, 0.0, {person(200, 0.8F)}, {});
    int frames = 0;
    while (!tracker.objects().empty() && frames < 1000) {
      ++frames;
      update(tracker, frames / rate, {}, {cv::Point2f(0.0F, 0.0F)});
    }
    EXPECT_NEAR(frames / rate, 1.5, 1.5 / rate) << rate;
  }
}

TEST(ObjectTracker, GoesOnWithItsOwnVelocityWithoutFlow) {
  ObjectTracker tracker({});
  update(tracker, 0.0, {person(200, 0.8F)}, {});
  update(tracker, 0.1, {}, {cv::Point2f(10.0F, -5.0F)});
  update(tracker, 0.3, {}, {std::nullopt});
  EXPECT_NEAR(tracker.objects()[0].object.box.x, 230.0F, 1e-3F);
  EXPECT_NEAR(tracker.objects()[0].object.box.y, 85.0F, 1e-3F);
}

TEST(ObjectTracker, LetsGoOfWhatLeavesTheImage) {
  ObjectTracker tracker({});
  update(tracker, 0.0, {person(500, 0.8F)}, {});
  int frames = 0;
  while (!tracker.objects().empty() && frames < 100) {
    ++frames;
    update(tracker, frames * 0.01, {}, {cv::Point2f(20.0F, 0.0F)});
  }
  EXPECT_EQ(frames, 7);  // 640 - (500 + 7 * 20) = 0; after 6 frames 20 of 100 px are left
}

TEST(ObjectTracker, DoesNotCarryThingsAndIgnoresFixedOnes) {
  ObjectTracker tracker({});
  Detection chair = person(50, 0.9F);
  chair.class_id = 56;
  chair.weight = 4.0F;
  Detection table = person(400, 0.9F);
  table.class_id = 60;
  table.weight = 1.0F;
  update(tracker, 0.0, {chair, table}, {});
  ASSERT_EQ(tracker.objects().size(), 1U);
  EXPECT_EQ(tracker.objects()[0].object.class_id, 56);
  update(tracker, 0.03, {}, {std::nullopt});
  EXPECT_TRUE(tracker.objects().empty());
}

TEST(ObjectTracker, KeepsTwoPeopleApart) {
  ObjectTracker tracker({});
  update(tracker, 0.0, {person(100, 0.8F), person(350, 0.7F)}, {});
  update(tracker, 0.03, {person(345, 0.8F), person(110, 0.7F)}, {});
  ASSERT_EQ(tracker.objects().size(), 2U);
  EXPECT_FLOAT_EQ(tracker.objects()[0].object.box.x, 110.0F);
  EXPECT_FLOAT_EQ(tracker.objects()[1].object.box.x, 345.0F);
}

TEST(ObjectTracker, CoversWholeBoxesAfterAGapAndElseSilhouettesWhereBoxesFillTheView) {
  const cv::Size view(160, 120);
  for (const double gap : {1.0 / 30.0, 0.16}) {
    ObjectTracker tracker({});
    Detection two = person(20, 0.8F);
    two.box = {0.0F, 0.0F, 640.0F, 460.0F};
    update(tracker, 0.0, {two}, {});
    ObjectMask mask;
    mask.area = {60, 30, 40, 80};
    mask.mask = cv::Mat(mask.area.size(), CV_8UC1, cv::Scalar(255));
    mask.mean_depth = 2.0F;
    tracker.set_mask(0, mask, true);
    update(tracker, gap, {two}, {cv::Point2f(0.0F, 0.0F)});
    const double share = cv::countNonZero(tracker.cover(view).hidden) / (160.0 * 120.0);
    if (gap < 0.1) {
      EXPECT_NEAR(share, 40.0 * 80.0 / (160.0 * 120.0), 0.02);
    } else {
      EXPECT_GT(share, 460.0 / 480.0);
    }
  }
}

TEST(ObjectTracker, AHoleInASilhouetteIsNoWindow) {
  const cv::Size view(160, 120);
  ObjectTracker tracker({});
  Detection two = person(20, 0.8F);
  two.box = {0.0F, 0.0F, 640.0F, 460.0F};
  update(tracker, 0.0, {two}, {});
  ObjectMask mask;
  mask.area = {60, 30, 40, 80};
  mask.mask = cv::Mat(mask.area.size(), CV_8UC1, cv::Scalar(255));
  mask.mask(cv::Rect(10, 20, 20, 40)) = 0;
  mask.mean_depth = 2.0F;
  tracker.set_mask(0, mask, true);
  update(tracker, 1.0 / 30.0, {two}, {cv::Point2f(0.0F, 0.0F)});
  EXPECT_EQ(tracker.cover(view).hidden.at<std::uint8_t>(70, 80), 0);
  EXPECT_EQ(tracker.cover(view).people.at<std::uint8_t>(70, 80), 255);
}

TEST(ObjectTracker, SeenToMoveIsAsGoodAsDetected) {
  ObjectTracker tracker({});
  update(tracker, 0.0, {person(200, 0.8F)}, {});
  ObjectMask mask;
  mask.area = {100, 50, 50, 125};
  mask.mask = cv::Mat(125, 50, CV_8UC1, cv::Scalar(255));
  mask.mean_depth = 2.0F;
  for (int i = 1; i <= 20; ++i) {
    update(tracker, i * 0.1, {}, {cv::Point2f(0.0F, 0.0F)});
    ASSERT_EQ(tracker.objects().size(), 1U) << i;
    tracker.set_mask(0, mask, true);
  }
  EXPECT_EQ(tracker.objects()[0].object.last_detected, 0.0);
}

/// A mask that fills the box, pixels of the image, at a depth.
ObjectMask mask_of(const cv::Rect& box, float depth) {
  ObjectMask mask;
  constexpr int step = DepthView::step;
  mask.area = cv::Rect(box.x / step, box.y / step, box.width / step, box.height / step);
  mask.mask = cv::Mat(mask.area.size(), CV_8UC1, cv::Scalar(255));
  mask.mean_depth = depth;
  mask.share = 0.5F;
  return mask;
}

TEST(ObjectTracker, ACarriedMaskThatRunsOverIntoTheRoomDoesNotTakeTheBoxAlong) {
  ObjectTracker tracker({});
  tracker.add_moving(mask_of({200, 100, 100, 200}, 2.0F));
  for (int i = 0; i < 30; ++i) {
    update(tracker, i / 30.0, {}, {cv::Point2f(0.0F, 0.0F)});
    ASSERT_EQ(tracker.objects().size(), 1U);
    const cv::Rect2f box = tracker.objects()[0].object.box;
    const cv::Rect wider(int(box.x) - 20, int(box.y) - 20, int(box.width) + 40,
                         int(box.height) + 40);
    tracker.set_mask(0, mask_of(wider & cv::Rect({0, 0}, image), 2.0F), true);
  }
  const cv::Rect2f box = tracker.objects()[0].object.box;
  EXPECT_NEAR(box.width, 130.0F, 4.0F);  // 1.3 times what it was
  EXPECT_NEAR(box.height, 260.0F, 4.0F);
  EXPECT_NEAR(box.x + 0.5F * box.width, 250.0F, 4.0F);
}

TEST(ObjectTracker, ABoxAsLargeAsTheImageGivesWayToThePersonInIt) {
  // (detections of the large one, score of the person, pixels that his mask lies aside of its)
  struct Case {
    int sightings;
    float score;
    int aside;
    bool stays;
  };
  for (const Case& c : {Case{1, 0.8F, 0, false}, Case{2, 0.8F, 0, false}, Case{3, 0.8F, 0, true},
                        Case{1, 0.5F, 0, true}, Case{1, 0.8F, 350, true}}) {
    ObjectTracker tracker({});
    Detection large = person(0, 0.6F);
    large.box = {0.0F, 0.0F, 620.0F, 480.0F};
    const ObjectMask of_large = mask_of({0, 0, 340, 480}, 1.0F);
    for (int i = 0; i < c.sightings; ++i) {
      update(tracker, 0.03 * i, {large}, {std::nullopt});
      tracker.set_mask(0, of_large, false);
    }
    Detection small = person(20.0F + static_cast<float>(c.aside), c.score);
    update(tracker, 0.03 * c.sightings, {small}, {cv::Point2f(0.0F, 0.0F)});
    ASSERT_EQ(tracker.objects().size(), 2U);
    tracker.set_mask(0, of_large, false);
    tracker.set_mask(1, mask_of({20 + c.aside, 100, 100, 250}, 1.0F), false);
    tracker.drop_duplicates();
    EXPECT_EQ(tracker.objects().size(), c.stays ? 2U : 1U) << c.sightings << ' ' << c.score;
    EXPECT_FLOAT_EQ(tracker.objects().back().object.score, c.score);
  }
}

TEST(ObjectTracker, WhatWasOnlySeenToMoveGivesWayToNobodyInIt) {
  ObjectTracker tracker({});
  const ObjectMask mask = mask_of({0, 0, 340, 480}, 1.0F);
  tracker.add_moving(mask);
  Detection part = person(20, 0.9F);
  part.class_id = Detection::motion_class;
  update(tracker, 0.03, {part}, {cv::Point2f(0.0F, 0.0F)});
  ASSERT_EQ(tracker.objects().size(), 2U);
  tracker.set_mask(0, mask, false);
  tracker.set_mask(1, mask_of({20, 100, 100, 250}, 1.0F), false);
  tracker.drop_duplicates();
  EXPECT_EQ(tracker.objects().size(), 2U);
}

TEST(ObjectTracker, ACarriedObjectThatComesNearerGrows) {
  ObjectTracker tracker({});
  tracker.add_moving(mask_of({200, 100, 100, 200}, 3.0F));
  update(tracker, 0.1, {}, {cv::Point2f(0.0F, 0.0F)});
  tracker.set_mask(0, mask_of({150, 0, 200, 400}, 1.5F), true);
  EXPECT_NEAR(tracker.objects()[0].object.box.width, 200.0F, 2.0F);
  update(tracker, 0.2, {}, {cv::Point2f(0.0F, 0.0F)});
  tracker.set_mask(0, mask_of({150, 0, 200, 400}, 3.0F), true);  // as far off as it was: too large
  EXPECT_NEAR(tracker.objects()[0].object.box.width, 130.0F, 2.0F);
}

/// A person who walks 10 px a frame at 10 Hz, and what is said of him `delay` frames later.
class LateAnswers : public ::testing::Test {
 protected:
  static float left(int frame) { return 100.0F + 10.0F * static_cast<float>(frame); }
  /// Everything in the image, 2 m off, moves by `flow` into the frame.
  void move_all(double time, const cv::Point2f& flow) {
    std::vector<cv::Point2f> points;
    FlowResult tracks;
    for (int y = 10; y < 480; y += 20) {
      for (int x = 10; x < 640; x += 20) {
        points.emplace_back(float(x), float(y));
        tracks.previous.push_back(points.back() - flow);
      }
    }
    tracks.tracked.assign(points.size(), 1);
    const cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(2.0F));
    history_.add(time, make_depth_view(depth, rays_), points, tracks);
  }
  /// The frame, with the answer about image `of`; none for a negative one.
  void frame(int index, int of, bool seen = true) {
    DetectionResult answer;
    if (of >= 0) {
      answer = {of * 0.1, true, {}};
      if (seen) answer.detections.push_back(person(left(of), 0.8F));
    }
    std::vector<std::optional<cv::Point2f>> flow;
    if (!tracker_.objects().empty()) flow.emplace_back(cv::Point2f(10.0F, 0.0F));
    move_all(index * 0.1, {10.0F, 0.0F});
    tracker_.update(index * 0.1, image, answer, flow, &history_);
  }
  const ObjectTracker::Tracked& only() const { return tracker_.objects().at(0); }

  ObjectTracker tracker_{ObjectTrackerOptions{}};
  cv::Mat rays_ = depth_view_rays(testing::vga_camera());
  MotionHistory history_{testing::vga_camera(), {}, 1.0};
};

TEST_F(LateAnswers, AreMovedToNowAndMeetWhoWasThereThen) {
  frame(0, 0);
  for (int i = 1; i < 5; ++i) frame(i, -1);
  const int id = only().object.id;
  for (int i = 5; i < 12; ++i) {
    frame(i, i - 4);  // the boxes of then and now do not even overlap by half
    ASSERT_EQ(tracker_.objects().size(), 1U) << i;
    EXPECT_EQ(only().object.id, id);
    EXPECT_FALSE(only().object.compensated);
    EXPECT_NEAR(only().object.box.x, left(i), 1e-2F);
    EXPECT_NEAR(only().object.last_detected, (i - 4) * 0.1, 1e-9);
  }
}

TEST_F(LateAnswers, HavingNoneIsNoMiss) {
  frame(0, 0);
  for (int i = 1; i <= 14; ++i) {
    frame(i, -1);
    ASSERT_EQ(tracker_.objects().size(), 1U) << i;
    EXPECT_FALSE(only().missed);
  }
  frame(16, -1);
  EXPECT_TRUE(tracker_.objects().empty());  // life goes on by time: 1.5 s
}

TEST_F(LateAnswers, NobodySeenIsAMiss) {
  frame(0, 0);
  frame(1, -1);
  frame(2, 1, false);
  ASSERT_EQ(tracker_.objects().size(), 1U);
  EXPECT_TRUE(only().missed);
  frame(3, -1);
  EXPECT_TRUE(only().missed);  // and stays one until there is a better answer
  frame(4, 3);
  EXPECT_FALSE(only().missed);
}

TEST_F(LateAnswers, TheSameOneAgainSaysNothingNew) {
  frame(0, 0);
  for (int i = 1; i <= 15; ++i) {
    frame(i, 0);
    ASSERT_EQ(tracker_.objects().size(), 1U) << i;
    EXPECT_TRUE(only().object.compensated);
    EXPECT_FALSE(only().missed);
    EXPECT_NEAR(only().object.box.x, left(i), 1e-2F);
  }
  frame(16, 0);
  EXPECT_TRUE(tracker_.objects().empty());
}

TEST_F(LateAnswers, WithoutCompensationAMissEndsALifeAndSilenceDoesNot) {
  ObjectTrackerOptions options;
  options.compensate = false;
  tracker_ = ObjectTracker(options);
  frame(0, 0);
  frame(1, -1);
  EXPECT_EQ(tracker_.objects().size(), 1U);
  EXPECT_EQ(tracker_.dropped_by_a_miss(), 0);
  frame(2, 2, false);
  EXPECT_TRUE(tracker_.objects().empty());
  EXPECT_EQ(tracker_.dropped_by_a_miss(), 1);
}

TEST_F(LateAnswers, OnesTooLateAreNotUsed) {
  for (int i = 0; i < 15; ++i) frame(i, i - 12);
  EXPECT_TRUE(tracker_.objects().empty());
}

TEST_F(LateAnswers, StartWhereTheyAreNow) {
  for (int i = 0; i < 6; ++i) frame(i, -1);
  frame(6, 2);
  ASSERT_EQ(tracker_.objects().size(), 1U);
  EXPECT_NEAR(only().object.box.x, left(6), 1e-2F);
  EXPECT_NEAR(only().velocity.x, 100.0F, 0.1F);
  EXPECT_NEAR(only().object.mean_depth, 2.0F, 0.02F);
}

TEST_F(LateAnswers, ReachAsFarAsTheMaskOfTheFrameBefore) {
  frame(0, 0);
  for (int i = 1; i < 4; ++i) frame(i, -1);
  const cv::Rect box = only().object.box;
  tracker_.set_mask(0, mask_of(cv::Rect(box.x - 10, box.y, box.width, box.height), 2.0F), true);
  frame(4, 1);
  EXPECT_NEAR(only().object.box.x, left(4) - 10.0F, 2.0F);
  EXPECT_NEAR(only().object.box.br().x, left(4) + 100.0F, 1e-2F);
  // But no farther than an object of its size can be seen to.
  tracker_.set_mask(0, mask_of(cv::Rect(0, 100, 400, 250), 2.0F), true);
  frame(5, 2);
  EXPECT_NEAR(only().object.box.width, 130.0F, 2.0F);
}

TEST_F(LateAnswers, WhoComesInReachesToTheBorderStill) {
  Detection entering = person(0.0F, 0.8F);
  entering.box.width = 40.0F;
  move_all(0.0, {});
  tracker_.update(0.0, image, {0.0, true, {entering}}, {}, &history_);
  move_all(0.1, {30.0F, 0.0F});
  tracker_.update(0.1, image, {}, {cv::Point2f(30.0F, 0.0F)}, &history_);
  entering.box.width = 70.0F;
  move_all(0.2, {30.0F, 0.0F});
  tracker_.update(0.2, image, {0.1, true, {entering}}, {cv::Point2f(30.0F, 0.0F)}, &history_);
  ASSERT_EQ(tracker_.objects().size(), 1U);
  EXPECT_FLOAT_EQ(only().object.box.x, 0.0F);
  EXPECT_NEAR(only().object.box.width, 100.0F, 1e-2F);
}

TEST(BoxIou, KnownValues) {
  EXPECT_FLOAT_EQ(box_iou({0, 0, 10, 10}, {5, 0, 10, 10}), 50.0F / 150.0F);
  EXPECT_FLOAT_EQ(box_iou({0, 0, 10, 10}, {20, 0, 10, 10}), 0.0F);
}

}  // namespace
}  // namespace dkp_slam
