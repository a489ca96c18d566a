#include "viewer/scene.h"

#include <cmath>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/image_files.h"
#include "viewer/cloud.h"
#include "viewer/test_client.h"

namespace dkp_slam::viewer {
namespace {

using dkp_slam::testing::head_of;
using dkp_slam::testing::section_of;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

/// Frame `i`, `i` metres along x, 0.1 s after the one before.
std::shared_ptr<FrameSnapshot> frame(int i, bool localised = true) {
  auto snapshot = std::make_shared<FrameSnapshot>();
  snapshot->result.index = snapshot->frame.index = i;
  snapshot->result.timestamp = snapshot->frame.timestamp = 100.0 + 0.1 * i;
  snapshot->result.localised = localised;
  snapshot->result.world_from_camera.translation.x() = i;
  snapshot->frame.colour = cv::Mat(48, 64, CV_8UC3, cv::Scalar(10 * i, 0, 0));
  snapshot->frame.depth = cv::Mat(48, 64, CV_32F, cv::Scalar(2.0F));
  return snapshot;
}

LandmarkState landmark(int id, double x) {
  LandmarkState state;
  state.id = id;
  state.position = {x, 0.0, 2.0};
  state.first_keyframe = 0;
  return state;
}

KeyframeState keyframe(int id, int first_landmark, int landmarks) {
  KeyframeState state;
  state.id = id;
  state.camera_from_world.translation.x() = -id;
  for (int l = 0; l < landmarks; ++l) state.landmarks.push_back(first_landmark + l);
  return state;
}

constexpr auto column = [](const std::vector<float>& rows, std::size_t which) {
  std::vector<float> values;
  for (std::size_t i = which; i < rows.size(); i += FrameRows::columns) values.push_back(rows[i]);
  return values;
};

/// A column of the frames that moved.
std::vector<float> moved(const std::string& update, std::size_t which) {
  const auto rows = section_of<float>(update, "moved");
  std::vector<float> values;
  for (std::size_t i = which; i < rows.size(); i += FrameRows::moved_columns)
    values.push_back(rows[i]);
  return values;
}

/// What a page knows once it has taken an update in.
PageState after(const std::string& update) {
  const auto head = head_of(update);
  return {head["run"], head["newest"], head["path"], head["map"],
          head["messages"].empty() ? 0 : head["messages"].back()["number"].get<int>()};
}

TEST(Scene, APageGetsWhatItLacks) {
  SceneInfo info;
  info.title = "there";
  Scene scene(info);
  scene.add_frame(frame(0));
  scene.add_frame(frame(1));
  const std::string first = scene.update({}, nullptr);
  EXPECT_EQ(head_of(first)["title"], "there");
  EXPECT_EQ(head_of(first)["path_reset"], true);
  EXPECT_THAT(column(section_of<float>(first, "frames"), 5), ElementsAre(0.0F, 1.0F));
  scene.add_frame(frame(2, false));
  scene.add_message("info", "hello");
  const std::string second = scene.update(after(first), nullptr);
  EXPECT_EQ(head_of(second)["path_reset"], false);
  EXPECT_THAT(column(section_of<float>(second, "frames"), 0), ElementsAre(2.0F));
  EXPECT_THAT(column(section_of<float>(second, "frames"), 2), ElementsAre(0.0F));
  EXPECT_EQ(head_of(second)["messages"][0]["text"], "hello");
  const std::string third = scene.update(after(second), nullptr);
  EXPECT_THAT(section_of<float>(third, "frames"), SizeIs(0));
  PageState of_another_run = after(second);
  of_another_run.run = "other";
  EXPECT_THAT(section_of<float>(scene.update(of_another_run, nullptr), "frames"),
              SizeIs(3 * FrameRows::columns));
}

TEST(Scene, AtTheEndThePathIsTheAdjustedOne) {
  Scene scene({});
  for (int i = 0; i < 3; ++i) scene.add_frame(frame(i));
  const PageState page = after(scene.update({}, nullptr));
  Trajectory adjusted;
  for (int i = 0; i < 3; ++i) {
    adjusted.push_back({100.0 + 0.1 * i, {}});
    adjusted.back().world_from_camera.translation.x() = 10.0 + i;
  }
  scene.finish(adjusted);
  const std::string update = scene.update(page, nullptr);
  EXPECT_EQ(head_of(update)["finished"], true);
  EXPECT_EQ(head_of(update)["path_reset"], false);
  EXPECT_THAT(moved(update, 0), ElementsAre(0.0F, 1.0F, 2.0F));
  EXPECT_THAT(moved(update, 2), ElementsAre(10.0F, 11.0F, 12.0F));
}

/// Keyframe `id` at x, of a map.
KeyframeState keyframe_at(int id, double x, int map = 0) {
  KeyframeState state;
  state.id = id;
  state.map = map;
  state.camera_from_world.translation.x() = -x;
  return state;
}

TEST(Scene, FramesMoveWithTheKeyframesThatTheyHangOn) {
  Scene scene({});
  for (int i = 0; i < 6; ++i) {
    // Two keyframes, at frames 0 and 3; the others hang on the last one.
    const auto snapshot = frame(i);
    snapshot->result.reference_keyframe = i / 3;
    snapshot->result.camera_from_reference.translation.x() = -(i % 3);
    scene.add_frame(snapshot);
    if (i % 3 == 0) {
      KeyframeSnapshot keyframe;
      keyframe.id = i / 3;
      keyframe.world_from_camera.translation.x() = i;
      scene.add_keyframe(keyframe);
    }
  }
  PageState page = after(scene.update({}, nullptr));
  MapChange change;
  change.keyframes = {keyframe_at(0, 0.0), keyframe_at(1, 3.002)};
  scene.apply(change);  // too little to be told
  EXPECT_THAT(moved(scene.update(page, nullptr), 0), SizeIs(0));
  change.keyframes = {keyframe_at(1, 4.0)};
  scene.apply(change);
  std::string update = scene.update(page, nullptr);
  EXPECT_EQ(head_of(update)["path_reset"], false);
  EXPECT_THAT(section_of<float>(update, "frames"), SizeIs(0));
  EXPECT_THAT(moved(update, 0), ElementsAre(3.0F, 4.0F, 5.0F));
  EXPECT_THAT(moved(update, 2), ElementsAre(4.0F, 5.0F, 6.0F));
  // A page that has less gets the rest as it lies now.
  PageState behind = page;
  behind.frame = 3;
  update = scene.update(behind, nullptr);
  EXPECT_THAT(moved(update, 0), ElementsAre(3.0F));
  EXPECT_THAT(column(section_of<float>(update, "frames"), 5), ElementsAre(5.0F, 6.0F));
  page = after(scene.update(page, nullptr));
  EXPECT_THAT(moved(scene.update(page, nullptr), 0), SizeIs(0));
  // A keyframe that goes leaves its frames to the one before it; a merge takes both elsewhere.
  change = {};
  change.removed_keyframes = {1};
  scene.apply(change);
  change = {};
  change.keyframes = {keyframe_at(0, 10.0, 2)};
  scene.apply(change);
  update = scene.update(page, nullptr);
  EXPECT_THAT(moved(update, 1), Each(2.0F));
  EXPECT_THAT(moved(update, 2), ElementsAre(10.0F, 11.0F, 12.0F, 14.0F, 15.0F, 16.0F));
}

TEST(Scene, TellsOfTheMapWhatChanged) {
  Scene scene({});
  MapChange change;
  for (int l = 0; l < 30; ++l) change.landmarks.push_back(landmark(l, l));
  change.keyframes = {keyframe(0, 0, 20), keyframe(1, 5, 20), keyframe(2, 12, 18)};
  scene.apply(change);
  const std::string first = scene.update({}, nullptr);
  const auto keyframes = head_of(first)["keyframes"];
  ASSERT_EQ(keyframes.size(), 3U);
  EXPECT_EQ(keyframes[1]["pose"][0], 1.0);
  // 0 and 1 share 15 landmarks, 0 and 2 share 8, 1 and 2 share 13: 15 make neighbours.
  EXPECT_EQ(keyframes[0]["near"], nlohmann::json::array({1}));
  EXPECT_EQ(keyframes[2]["near"], nlohmann::json::array());
  EXPECT_THAT(section_of<int>(first, "landmark_ids"), SizeIs(30));

  MapChange later;
  later.landmarks = {landmark(3, 7.0)};
  later.removed_landmarks = {4};
  later.removed_keyframes = {2};
  scene.apply(later);
  const std::string second = scene.update(after(first), nullptr);
  EXPECT_EQ(head_of(second)["map_reset"], false);
  EXPECT_EQ(head_of(second)["gone_keyframes"], nlohmann::json::array({2}));
  EXPECT_THAT(section_of<int>(second, "landmark_ids"), ElementsAre(3));
  EXPECT_THAT(section_of<float>(second, "landmark_positions"), ElementsAre(7.0F, 0.0F, 2.0F));
  EXPECT_THAT(section_of<int>(second, "gone_landmarks"), ElementsAre(4));
}

TEST(Scene, APictureIsMadeWhenSomebodyAsks) {
  Scene scene({});
  EXPECT_EQ(scene.picture({}), nullptr);
  auto snapshot = frame(3);
  snapshot->keypoints = {cv::KeyPoint(10.0F, 20.0F, 1.0F), cv::KeyPoint(30.0F, 20.0F, 1.0F)};
  snapshot->dynamics.features.resize(2);
  snapshot->dynamics.features[1].region = Region::high;
  snapshot->dynamics.features[1].is_static = false;
  snapshot->dynamics.mask = cv::Mat::zeros(48, 64, CV_8U);
  snapshot->dynamics.mask(cv::Rect(16, 12, 32, 24)) = 255;
  scene.add_frame(snapshot);
  EXPECT_EQ(scene.picture(3), nullptr);  // none is kept that nobody asked for
  const auto picture = scene.picture({});
  ASSERT_NE(picture, nullptr);
  const auto head = head_of(*picture);
  EXPECT_EQ(head["frame"], 3);
  ASSERT_EQ(head["mask"].size(), 1U);
  EXPECT_NEAR(head["mask"][0][0].get<double>(), 16.5 / 64, 1e-3);
  const auto features = section_of<std::uint16_t>(*picture, "features");
  ASSERT_THAT(features, SizeIs(6));
  EXPECT_NEAR(features[0] / 65535.0, 10.5 / 64, 1e-4);
  EXPECT_EQ(features[2], 4);  // low, static
  EXPECT_EQ(features[5], 2);  // high, removed
  const cv::Mat image = testing::image_of(section_of<std::uint8_t>(*picture, "jpeg"));
  EXPECT_EQ(image.size(), cv::Size(64, 48));
  EXPECT_NEAR(image.at<cv::Vec3b>(24, 32)[0], 30, 4);
  EXPECT_EQ(scene.picture(5), picture);  // the last one before
  EXPECT_EQ(scene.picture(2), nullptr);
}

TEST(Scene, ADenseCloudLeavesOutMasksAndEdges) {
  Camera camera;
  camera.width = 64;
  camera.height = 48;
  camera.fx = camera.fy = 50.0;
  camera.cx = 32.0;
  camera.cy = 24.0;
  auto snapshot = frame(0);
  snapshot->frame.depth(cv::Rect(32, 0, 32, 48)) = 4.0F;
  snapshot->dynamics.mask = cv::Mat::zeros(48, 64, CV_8U);
  snapshot->dynamics.mask(cv::Rect(0, 24, 64, 24)) = 255;
  const std::string cloud = make_cloud(*snapshot, camera, 6);
  const auto positions = section_of<std::int16_t>(cloud, "positions");
  ASSERT_GT(positions.size(), 60U);
  for (std::size_t i = 0; i < positions.size(); i += 3) {
    EXPECT_LT(positions[i + 1], 0);  // above the mask
    EXPECT_TRUE(positions[i + 2] == 2000 || positions[i + 2] == 4000);
    if (positions[i + 2] == 4000) {
      EXPECT_GE(positions[i], 160);  // two pixels from the edge
    }
  }
}

TEST(Scene, ComparesWithTheTruthUpToARigidMotion) {
  SceneInfo info;
  for (int i = 0; i < 20; ++i) {
    info.truth.push_back({100.0 + 0.1 * i, {}});
    // The path turned by a right angle and moved; one frame 0.1 m off.
    info.truth.back().world_from_camera.translation = {5.0, static_cast<double>(i), 0.1 * i * i};
  }
  Scene scene(info);
  for (int i = 0; i < 20; ++i) {
    auto snapshot = frame(i);
    snapshot->result.world_from_camera.translation = {static_cast<double>(i), 0.0, 0.1 * i * i};
    scene.add_frame(snapshot);
  }
  const auto report = scene.error();
  ASSERT_NE(report, nullptr);
  EXPECT_EQ(head_of(*report)["matches"], 20);
  EXPECT_LT(head_of(*report)["rmse"].get<double>(), 1e-5);
  const auto truth = section_of<float>(*report, "truth");
  ASSERT_EQ(truth.size() % 3, 0U);
  EXPECT_NEAR(truth[3], 1.0, 1e-3);  // in the frame of the path
  EXPECT_EQ(Scene({}).error(), nullptr);
}

}  // namespace
}  // namespace dkp_slam::viewer
