#include "dkp_slam/dynamics/masks/clustering.h"

#include <cmath>
#include <initializer_list>

#include <gtest/gtest.h>

#include "tests/support/vga_camera.h"

namespace dkp_slam {
namespace {

/// A room with exact depth: wall at 4 m, floor 1.2 m under the camera.
class Room {
 public:
  Room() : depth_(480, 640, CV_32FC1), truth_(cv::Mat::zeros(480, 640, CV_8UC1)) {
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        const double down = (y - camera_.cy) / camera_.fy;
        depth_.at<float>(y, x) = static_cast<float>(down > 0.0 ? std::min(4.0, 1.2 / down) : 4.0);
      }
    }
  }
  /// A rounded body (half an elliptic cylinder, 0.12 m deep) over a rectangle of pixels.
  void add_person(const cv::Rect& box, float z, bool in_truth = true) {
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = box.x; x < box.x + box.width; ++x) {
        const float u =
            (static_cast<float>(x - box.x) + 0.5F) / static_cast<float>(box.width) * 2 - 1;
        const float surface = z - 0.12F * std::sqrt(1.0F - u * u);
        if (surface >= depth_.at<float>(y, x)) continue;
        depth_.at<float>(y, x) = surface;
        truth_.at<std::uint8_t>(y, x) = in_truth ? 255 : 0;
      }
    }
  }
  /// A flat screen facing the camera, its middle `bend` metres behind its edges.
  void add_screen(const cv::Rect& box, float z, float bend = 0.0F) {
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = box.x; x < box.x + box.width; ++x) {
        const float u =
            (static_cast<float>(x - box.x) + 0.5F) / static_cast<float>(box.width) * 2 - 1;
        depth_.at<float>(y, x) = z + bend * (1.0F - u * u);
      }
    }
    truth_(box).setTo(0);
  }
  ObjectMask cut(const cv::Rect2f& box, const ObjectPrior& prior = {},
                 ClusteringOptions options = {}) const {
    return cluster_object(scene(box, options), box, prior, options, 1);
  }
  Scene scene(const cv::Rect2f& box, const ClusteringOptions& options = {}) const {
    const DepthView view = make_depth_view(depth_, depth_view_rays(camera_));
    cv::Mat covered = cv::Mat::zeros(view.depth.size(), CV_8UC1);
    covered(view_rect(box, covered.size())) = 255;
    return make_scene(view, camera_.fx, fit_planes(view, covered, options.planes, 1), options, 1);
  }
  double iou(const ObjectMask& mask) const {
    cv::Mat labels = cv::Mat::zeros(480, 640, CV_8UC1);
    if (!mask.empty()) paint_object(mask, 255, labels);
    const double common = cv::countNonZero(labels & truth_);
    return common / cv::countNonZero(labels | truth_);
  }
  const cv::Mat& depth() const { return depth_; }

 private:
  Camera camera_ = testing::vga_camera();
  cv::Mat depth_, truth_;
};

/// Twelve features move on each of the surfaces at these columns of the image, in row 250; so many
/// of them for sure.
void let_move(Scene& scene, std::initializer_list<int> columns, int surely = 12) {
  for (const int x : columns) {
    const int index = segment_near(scene.surfaces, x / 2, 250 / 2);
    ASSERT_GE(index, 0);
    scene.surfaces.segments[static_cast<std::size_t>(index)].moving = 12;
    scene.surfaces.segments[static_cast<std::size_t>(index)].surely_moving = surely;
  }
}

TEST(Clustering, CutsAPersonOutOfARoom) {
  Room room;
  room.add_person({250, 80, 120, 380}, 2.0F);
  const ObjectMask mask = room.cut({240, 70, 140, 400});
  EXPECT_GT(room.iou(mask), 0.93);
  EXPECT_NEAR(mask.mean_depth, 1.91F, 0.03F);
  EXPECT_NEAR(mask.share, 120.0 * 380.0 / (140.0 * 400.0), 0.06);
  EXPECT_GE(mask.clusters, 2);
}

TEST(Clustering, LiteralEquationTakesTheWholeBox) {
  // algorithm.md: Eq. 1 in raw units gives K = 1, so wall and floor go with the person.
  Room room;
  room.add_person({250, 80, 120, 380}, 2.0F);
  ClusteringOptions options;
  options.mode = ClusteringMode::paper;
  const ObjectMask mask = room.cut({220, 60, 180, 410}, {}, options);
  EXPECT_EQ(mask.clusters, 1);
  EXPECT_LT(room.iou(mask), 0.7);
}

TEST(Clustering, BandAgreesWithTheClusters) {
  Room room;
  room.add_person({250, 80, 120, 380}, 2.0F);
  ClusteringOptions options;
  options.mode = ClusteringMode::band;
  EXPECT_GT(room.iou(room.cut({240, 70, 140, 400}, {}, options)), 0.93);
}

TEST(Clustering, MaskGrowsOutOfABoxThatIsTooTight) {
  Room room;
  room.add_person({250, 80, 120, 380}, 2.0F);
  EXPECT_GT(room.iou(room.cut({255, 120, 110, 300})), 0.9);
}

TEST(Clustering, TakesNoScreenInFrontOfAHiddenPerson) {
  // The box is the head's and shoulders', most of it shows the screen in front.
  Room room;
  room.add_person({300, 100, 80, 200}, 2.6F);
  room.add_screen({240, 150, 200, 130}, 1.2F);
  const ObjectMask mask = room.cut({295, 95, 95, 190});
  cv::Mat labels = cv::Mat::zeros(480, 640, CV_8UC1);
  if (!mask.empty()) paint_object(mask, 255, labels);
  EXPECT_LT(cv::countNonZero(labels(cv::Rect(240, 150, 200, 130))), 600);
}

TEST(Clustering, PartsAPersonFromAScreenAtTheSameDepth) {
  // Flat, and bent by 8 mm, 1.7 times the half thickness of a flat patch there.
  for (const float bend : {0.0F, 0.008F}) {
    Room room;
    room.add_screen({150, 120, 160, 130}, 0.9F, bend);
    room.add_person({300, 60, 160, 400}, 0.99F);
    EXPECT_GT(room.iou(room.cut({290, 55, 180, 410})), 0.9) << bend;
  }
}

TEST(Clustering, AFlatThingTooLargeForAPersonIsNoneThoughItsFeaturesMove) {
  // A cupboard behind somebody at whose outline features lie that move with him.
  Room room;
  room.add_screen({345, 150, 90, 150}, 2.3F);
  room.add_person({220, 90, 120, 370}, 1.2F);
  const cv::Rect2f box(210, 80, 250, 390);
  const ClusteringOptions options;
  Scene scene = room.scene(box, options);
  ASSERT_NO_FATAL_FAILURE((let_move(scene, {280, 390})));
  EXPECT_GT(room.iou(cluster_object(scene, box, {}, options, 1)), 0.9);
}

/// Two people at different depths, at columns 275 and 380, in one box.
class TwoInABox {
 public:
  TwoInABox() {
    room_.add_person({220, 90, 110, 370}, 1.6F);
    room_.add_person({335, 110, 90, 300}, 2.6F);
    scene = room_.scene(box_, {});
  }
  /// Of the box's mask and both of them.
  double iou(const ObjectPrior& prior = {}) const {
    return room_.iou(cluster_object(scene, box_, prior, {}, 1));
  }
  Scene scene;

 private:
  Room room_;
  cv::Rect2f box_{210, 80, 225, 390};
};

TEST(Clustering, TakesASecondMoverAtAnotherDepthIntoTheBox) {
  TwoInABox two;
  EXPECT_LT(two.iou(), 0.75);
  ASSERT_NO_FATAL_FAILURE((let_move(two.scene, {275, 380})));
  EXPECT_GT(two.iou(), 0.9);
}

TEST(Clustering, TakesASecondMoverIntoANamedPersonsBoxOnlyWhenItMovesForSure) {
  // Where the ego-motion is not sure a static thing moves as well as somebody; and to a box that no
  // network gave the second may be the one it is about.
  TwoInABox two;
  ObjectPrior named;
  named.named = true;
  ASSERT_NO_FATAL_FAILURE((let_move(two.scene, {275, 380}, 0)));
  EXPECT_LT(two.iou(named), 0.75);
  EXPECT_GT(two.iou(), 0.9);
  ASSERT_NO_FATAL_FAILURE((let_move(two.scene, {275, 380})));
  EXPECT_GT(two.iou(named), 0.9);
}

TEST(Clustering, FollowsThePriorRatherThanTheLargest) {
  Room room;
  room.add_person({220, 90, 130, 370}, 1.6F, false);
  room.add_person({360, 110, 90, 330}, 2.6F);
  ObjectPrior prior;
  prior.mean_depth = 2.52F;
  prior.share = 0.3F;
  prior.carried = true;
  prior.mask.area = {180, 55, 45, 165};
  prior.mask.mask = cv::Mat(165, 45, CV_8UC1, cv::Scalar(255));
  prior.mask.mean_depth = 2.52F;
  EXPECT_GT(room.iou(room.cut({340, 100, 120, 350}, prior)), 0.9);
}

TEST(Clustering, NothingInAnEmptyOrUnknownBox) {
  Room room;
  EXPECT_TRUE(room.cut({-50, -50, 20, 20}).empty());
  const DepthView view =
      make_depth_view(cv::Mat::zeros(480, 640, CV_32FC1), depth_view_rays(testing::vga_camera()));
  const Scene scene = make_scene(view, 525.0, fit_planes(view, {}, {}, 1), {}, 1);
  EXPECT_TRUE(cluster_object(scene, {100, 100, 200, 200}, {}, {}, 1).empty());
}

TEST(Clustering, SilhouetteOfTheDetectorIsTakenAsItIs) {
  Room room;
  room.add_person({250, 80, 120, 380}, 2.0F);
  const DepthView view = make_depth_view(room.depth(), depth_view_rays(testing::vga_camera()));
  const cv::Mat silhouette(380, 120, CV_8UC1, cv::Scalar(255));
  EXPECT_GT(room.iou(mask_from_silhouette(view, silhouette, {250, 80, 120, 380})), 0.99);
}

TEST(Planes, FindsTheFloorAndLeavesWhoStandsOnIt) {
  Room room;
  room.add_person({250, 80, 120, 380}, 2.0F);
  const Scene scene = room.scene({240, 70, 140, 400});
  EXPECT_EQ(scene.planes.at<std::uint8_t>(200, 40), 255);  // floor
  EXPECT_EQ(scene.planes.at<std::uint8_t>(50, 40), 255);   // wall
  EXPECT_EQ(scene.planes.at<std::uint8_t>(120, 155), 0);   // body
}

}  // namespace
}  // namespace dkp_slam
